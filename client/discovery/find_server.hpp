// SPDX-License-Identifier: MIT
// How a client finds its server: by address, or by the name under which the server announces itself
// on the LAN (DNS-SD). The client never connects to a server that the user did not name, because
// any host can announce itself and the server moves a hand.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/discovery/mdns_browser.hpp"
#include "client/net/dial.hpp"
#include "common/endpoint.hpp"

namespace hapticast::client {

// The servers that mDNS found on the LAN. Their names and texts come from strangers: toText()
// bounds and cleans them. Pure functions.

struct FoundServer {
  std::string name;  ///< as received
  std::string host;
  Endpoint address;
  std::string interface_name;
  std::string plays;          ///< title of the content
  std::uint32_t version = 0;  ///< of the protocol; 0: not announced
  bool operator==(const FoundServer&) const = default;
};

/// Returns each server once, with its first address: IPv4 before IPv6, then by interface.
[[nodiscard]] std::vector<FoundServer> eachOnce(std::vector<FoundServer> found);

/// Returns the only server that is announced as `name`; otherwise nothing, and `why` gets the
/// reason: no server, or which addresses announce `name`.
[[nodiscard]] std::optional<FoundServer> only(const std::vector<FoundServer>& found,
                                              const std::string& name, std::string& why);

/// Lines that toText() prints at most. Chosen: what a person still reads.
constexpr std::size_t kMaxListedServers = 32;

/// Returns one line for each server, and a last line where there are more than kMaxListedServers.
/// The last line has no line end. Control characters of strangers are replaced.
[[nodiscard]] std::string toText(const std::vector<FoundServer>& servers);

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
