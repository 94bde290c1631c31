// SPDX-License-Identifier: MIT
#include "client/discovery/find_server.hpp"

#include <algorithm>
#include <cstdio>
#include <thread>
#include <tuple>
#include <utility>

#include "common/mdns.hpp"
#include "common/protocol/messages.hpp"
#include "common/text.hpp"

namespace hapticast::client {

namespace {

auto identity(const FoundServer& server) {
  return std::tie(server.name, server.host, server.address.port);
}

std::string formatVersion(const FoundServer& server) {
  if (server.version == kProtocolVersion) return "";
  if (server.version == 0) return "  (protocol version not announced)";
  return "  (protocol version " + std::to_string(server.version) + ", this client " +
         std::to_string(kProtocolVersion) + ")";
}

std::string inOneLine(const FoundServer& server) {
  constexpr std::size_t kMaxHost_bytes = 64;  // chosen; a name of DNS may have 255
  const std::string plays = sanitizeUtf8(server.plays, kMaxServicePlays_bytes);
  std::string line = "  " + sanitizeUtf8(server.name, kMaxServiceName_bytes) + "  at ";
  line.append(sanitizeUtf8(server.host, kMaxHost_bytes)).append("  ");
  line.append(toString(server.address)).append("  ").append(server.interface_name);
  if (!plays.empty()) line.append("  plays ").append(plays);
  return line.append(formatVersion(server));
}

}  // namespace

std::vector<FoundServer> eachOnce(std::vector<FoundServer> found) {
  const auto order = [](const FoundServer& server) {
    return std::tuple_cat(
        identity(server),
        std::make_tuple(isV6(server.address), server.interface_name, server.address.host));
  };
  std::sort(found.begin(), found.end(),
            [&](const auto& a, const auto& b) { return order(a) < order(b); });
  const auto same = [](const auto& a, const auto& b) { return identity(a) == identity(b); };
  found.erase(std::unique(found.begin(), found.end(), same), found.end());
  return found;
}

std::optional<FoundServer> only(const std::vector<FoundServer>& found, const std::string& name,
                                std::string& why) {
  std::optional<FoundServer> the_one;
  for (const FoundServer& each : found) {
    if (each.name != name) continue;
    if (the_one) {
      why = "more than one host announces this name: " + toString(the_one->address) + ", " +
            toString(each.address);
      return std::nullopt;
    }
    the_one = each;
  }
  if (!the_one) why = "no server announces this name";
  return the_one;
}

std::string toText(const std::vector<FoundServer>& servers) {
  std::vector<std::string> lines;
  for (const FoundServer& server : servers) {
    if (lines.size() == kMaxListedServers) {
      lines.emplace_back("  and more, which are not shown");
      break;
    }
    lines.push_back(inOneLine(server));
  }
  return join(lines, "\n");
}

namespace {

// Chosen: twice the time after which a lost first query is repeated.
constexpr std::chrono::milliseconds kSearch(2000);
constexpr std::chrono::milliseconds kStep(50);
constexpr Duration kLookAgain = std::chrono::seconds(1);

asio::awaitable<Dialled> searchAndDial(std::shared_ptr<Discovery> discovery, std::string name,
                                       asio::io_context& io, Duration deadline,
                                       DialCancellation& stop) {
  asio::steady_timer timer(io);
  std::string why;
  for (auto searched = Duration::zero(); searched < Duration(kSearch); searched += kStep) {
    const auto found = only(discovery->servers(), name, why);
    if (found) co_return co_await dialTcp(io, found->address, deadline, stop);
    stop.onStop([&timer] { timer.cancel(); });
    boost::system::error_code ignored;
    timer.expires_after(kStep);
    co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    stop.onStop({});
    if (stop.stopped()) co_return DialError{"stopped"};
  }
  const std::string absent = discovery->absent();
  co_return DialError{absent.empty() ? why : absent};
}

}  // namespace

Dial dialAnnounced(std::string name) {
  return [discovery = std::make_shared<Discovery>(), name = std::move(name)](
             asio::io_context& io, const Endpoint& /*unused*/, Duration deadline,
             DialCancellation& stop) { return searchAndDial(discovery, name, io, deadline, stop); };
}

std::optional<std::string> ServerHint::update(LocalTime now) {
  if (now < next_look_) return std::nullopt;
  next_look_ = now + kLookAgain;
  if (!discovery_) discovery_ = std::make_unique<Discovery>();
  std::string text = discovery_->absent();
  if (text.empty()) {
    text = toText(discovery_->servers());
    if (!text.empty())
      text = "servers on the LAN (HOST:PORT or mdns:NAME as argument selects one):\n" + text;
  } else {
    text = "no search for servers on the LAN: " + text;
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
  const std::string absent = discovery.absent();
  std::fprintf(stderr, "hapticast-client: %s\n",
               absent.empty() ? "no server is announced on the LAN"
                              : ("no search for servers on the LAN: " + absent).c_str());
  return false;
}

}  // namespace hapticast::client
