// SPDX-License-Identifier: MIT
// Finds a server by the name that the server announces on the LAN (DNS-SD over mDNS). The client
// never selects an announced server by itself. The user has to name it, because any host can
// announce itself, and a server moves the user's hand.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/net/dial.hpp"
#include "client/servers/mdns_browser.hpp"

namespace hapticast::client {

/// Type of a function that returns the dial function for a found server.
using DialFound = std::function<Dial(const FoundServer&)>;

/// Returns a dial function for the server that is announced as `name`. Each call of that function
/// waits up to 2 s for the announcement. It then dials the server with the result of `dial_found`.
/// It returns an error if no server, or more than one, announces `name`. Thread of its calls:
/// network.
[[nodiscard]] Dial dialAnnounced(std::string name, DialFound dial_found);

/// Lists the servers on the LAN, as long as no server answers at the default address. Thread: main.
class ServerHint {
 public:
  /// Searches for servers. Returns the text to log if the list has changed, else nullopt. Call it
  /// in each cycle of the event loop until the first connection.
  std::optional<std::string> update(LocalTime now);

 private:
  std::unique_ptr<Discovery> discovery_;  // from the first update
  LocalTime next_update_{};
  std::string logged_;
};

/// Carries out --list: searches for 2 s and prints the servers. If there is none, it prints the
/// reason on stderr. Returns true if there is a server.
bool listServers();

}  // namespace hapticast::client
