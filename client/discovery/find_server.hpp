// SPDX-License-Identifier: MIT
// How a client finds its server: by address, or by the name under which the server announces itself
// on the LAN (DNS-SD). The client never connects to a server that the user did not name, because
// any host can announce itself and the server moves a hand.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "client/discovery/mdns_browser.hpp"
#include "client/net/dial.hpp"

namespace hapticast::client {

/// Returns a dial function for the only server that is announced as `name`. Each call waits up to
/// 2 s for the announcement. Errors: no server, or more than one, announces `name`. Thread of its
/// calls: network.
[[nodiscard]] Dial dialAnnounced(std::string name);

/// Lists the servers on the LAN while none answers at the default address. Thread: main.
class ServerHint {
 public:
  /// Call in each turn of the event loop until the first connection. Returns the text to log, when
  /// the list has changed.
  std::optional<std::string> update(LocalTime now);

 private:
  std::unique_ptr<Discovery> discovery_;  // from the first update
  LocalTime next_look_{};
  std::string logged_;
};

/// --list: searches for 2 s and prints the servers, or on stderr why there is none. Returns whether
/// there is any.
bool listServers();

}  // namespace hapticast::client
