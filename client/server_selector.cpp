// SPDX-License-Identifier: MIT
#include "client/server_selector.hpp"

#include <cstdio>
#include <thread>
#include <utility>

#include "common/mdns.hpp"

namespace hapticast::client {

namespace {

// Chosen: twice as long as a first question that got lost takes to be asked again.
constexpr std::chrono::milliseconds kLook(2000);
constexpr std::chrono::milliseconds kStep(50);
constexpr Duration kLookAgain = std::chrono::seconds(1);
constexpr Duration kAfterNews = std::chrono::seconds(5);  // chosen: the time to read a list

}  // namespace

ServerSelector::ServerSelector(const Settings& settings)
    : server_(settings.server), announced_(settings.announced), is_asking_(!settings.server_given) {
  if (!announced_.empty()) discovery_ = std::make_unique<Discovery>();
}

Dial ServerSelector::dial() {
  if (!is_asking_ && announced_.empty()) return dialTcp;
  const auto how = is_asking_ ? &ServerSelector::dialChosen : &ServerSelector::dialAnnounced;
  return [this, how](asio::io_context& io, const Endpoint& server, Duration deadline,
                     DialCancellation& stop) { return (this->*how)(io, server, deadline, stop); };
}

asio::awaitable<Dialled> ServerSelector::dialChosen(asio::io_context& io, const Endpoint& server,
                                                    Duration deadline, DialCancellation& stop) {
  Endpoint endpoint = server;
  {
    const std::lock_guard lock(mutex_);
    if (chosen_) endpoint = chosen_->address;
  }
  Dialled dialled = co_await dialTcp(io, endpoint, deadline, stop);
  if (!dialled.ok()) none_here_ = true;
  co_return dialled;
}

asio::awaitable<Dialled> ServerSelector::dialAnnounced(asio::io_context& io,
                                                       const Endpoint& /*none*/, Duration deadline,
                                                       DialCancellation& stop) {
  asio::steady_timer timer(io);
  std::string why;
  for (auto looked = Duration::zero(); looked < Duration(kLook); looked += kStep) {
    const auto found = only(discovery_->servers(), announced_, why);
    if (found) co_return co_await dialTcp(io, found->address, deadline, stop);
    stop.onStop([&timer] { timer.cancel(); });
    boost::system::error_code ignored;
    timer.expires_after(kStep);
    co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    stop.onStop({});
    if (stop.stopped()) co_return DialError{"stopped"};
  }
  const std::string absent = discovery_->absent();
  co_return DialError{absent.empty() ? why : absent};
}

std::string ServerSelector::name() const {
  if (!announced_.empty()) return "mdns:" + announced_;
  const std::lock_guard lock(mutex_);
  if (!chosen_) return toString(server_);
  return printable(chosen_->name, kMaxServiceName_bytes) + " at " + toString(chosen_->address);
}

std::optional<std::string> ServerSelector::update(bool connected, LocalTime now) {
  if (!is_asking_ || over_) return std::nullopt;
  over_ = connected;
  if (over_) discovery_.reset();
  if (over_ || !none_here_) return std::nullopt;
  if (!discovery_) discovery_ = std::make_unique<Discovery>();
  if (shown_ && terminal_.isInteractive()) {
    if (const auto typed = terminal_.pop()) return onInput(*typed);
  }
  if (!next_look_) next_look_ = now + kLookAgain;
  if (now < *next_look_) return std::nullopt;
  auto told = readServers();
  next_look_ = now + (told ? kAfterNews : kLookAgain);
  return told;
}

std::optional<std::string> ServerSelector::readServers() {
  const std::string absent = discovery_->absent();
  if (!absent.empty()) {
    if (std::exchange(logged_absent_, true)) return std::nullopt;
    return "no search for servers on the LAN: " + absent;
  }
  if (!list_.update(discovery_->servers()) || list_.empty()) return std::nullopt;
  const bool asked = terminal_.isInteractive();
  if (asked && !std::exchange(shown_, true)) terminal_.discardPending();
  return "announced on the LAN, where any host can call itself a server:\n" + list_.toText() +
         (asked ? "\nto be touched: its number or name, and Enter; or this machine's, as soon as "
                  "there is one"
                : "\nno terminal to choose one: waiting for this machine's; HOST:PORT or mdns:NAME "
                  "takes one of these");
}

std::string ServerSelector::onInput(const std::string& typed) {
  std::string why;
  auto server = list_.choose(typed, why);
  if (!server) return why;
  {
    const std::lock_guard lock(mutex_);
    chosen_ = std::move(server);
  }
  return "taking " + name();
}

bool listServers() {
  const Discovery discovery;
  std::this_thread::sleep_for(kLook);
  ServerList list;
  list.update(discovery.servers());
  if (!list.empty()) {
    std::puts(list.toText().c_str());
    return true;
  }
  const std::string absent = discovery.absent();
  std::fprintf(stderr, "hapticast-client: %s\n",
               absent.empty() ? "no server is announced on the LAN"
                              : ("servers cannot be looked for: " + absent).c_str());
  return false;
}

}  // namespace hapticast::client
