// SPDX-License-Identifier: MIT
// The servers that mDNS found on the LAN. Their names and texts come from strangers: toText()
// bounds and cleans them. Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/endpoint.hpp"

namespace hapticast::client {

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

}  // namespace hapticast::client
