// SPDX-License-Identifier: MIT
#include "client/servers/find_server.hpp"

#include <spdlog/spdlog.h>

#include <cstdio>
#include <thread>
#include <utility>

#include "client/servers/server_list.hpp"

namespace hapticast::client {

namespace {

// Chosen: twice the time after which a lost first query is repeated.
constexpr std::chrono::milliseconds kSearch(2000);
constexpr std::chrono::milliseconds kStep(50);
// Chosen: a daemon answers its clients much sooner.
constexpr std::chrono::milliseconds kNoDaemon(500);
constexpr Duration kUpdateInterval = std::chrono::seconds(1);
constexpr const char* kNoSearch = "no search for servers on the LAN: ";  // a reason follows

asio::awaitable<Dialled> searchAndDial(std::shared_ptr<Discovery> discovery, std::string name,
                                       DialFound dial_found, asio::io_context& io,
                                       Duration deadline, DialCancellation& stop) {
  asio::steady_timer timer(io);
  std::string why;
  for (auto searched = Duration::zero(); searched < Duration(kSearch); searched += kStep) {
    const std::string absence = discovery->describeAbsence();
    if (!absence.empty() && searched >= Duration(kNoDaemon)) co_return DialError{absence};
    const auto found = only(discovery->servers(), name, why);
    if (found) {
      const Dial dial = dial_found(*found);
      co_return co_await dial(io, found->address, deadline, stop);
    }
    stop.onStop([&timer] { timer.cancel(); });
    boost::system::error_code ignored;
    timer.expires_after(kStep);
    co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    stop.onStop({});
    if (stop.stopped()) co_return DialError{"stopped"};
  }
  co_return DialError{why};
}

}  // namespace

Dial dialAnnounced(std::string name, DialFound dial_found) {
  return [discovery = std::make_shared<Discovery>(), name = std::move(name),
          dial_found = std::move(dial_found)](asio::io_context& io, const Endpoint& /*unused*/,
                                              Duration deadline, DialCancellation& stop) {
    return searchAndDial(discovery, name, dial_found, io, deadline, stop);
  };
}

std::optional<std::string> ServerHint::update(LocalTime now) {
  if (now < next_update_) return std::nullopt;
  next_update_ = now + kUpdateInterval;
  if (!discovery_) discovery_ = std::make_unique<Discovery>();
  std::string text = discovery_->describeAbsence();
  if (text.empty()) {
    text = toText(discovery_->servers());
    if (!text.empty())
      text = "servers on the LAN (HOST:PORT or mdns:NAME as argument selects one):\n" + text;
  } else {
    text = kNoSearch + text;
  }
  if (text == logged_) return std::nullopt;
  logged_ = text;
  return text.empty() ? std::nullopt : std::optional(text);
}

bool listServers() {
  const Discovery discovery;
  std::this_thread::sleep_for(kSearch);
  const std::string text = toText(discovery.servers());
  if (!text.empty()) {
    std::puts(text.c_str());
    return true;
  }
  const std::string absence = discovery.describeAbsence();
  spdlog::error("{}", absence.empty() ? "no server is announced on the LAN" : kNoSearch + absence);
  return false;
}

}  // namespace hapticast::client
