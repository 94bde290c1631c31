// SPDX-License-Identifier: MIT
// The servers that the search on the LAN has found. Any host can announce names and texts, so
// toText() limits their length and replaces control characters.
// Thread: any (pure functions).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/endpoint.hpp"

namespace hapticast::client {

struct FoundServer {
  std::string name;  ///< name as received; may have control characters
  std::string host;
  Endpoint address;
  std::string interface_name;
  std::string plays;          ///< title of the content
  std::uint32_t version = 0;  ///< version of the protocol; 0: not announced
  std::string tls;            ///< fingerprint of its TLS certificate, as received; empty: no TLS
  bool operator==(const FoundServer&) const = default;
};

/// Returns each server (name, host and port) of `found` once, in the order of these, with one of
/// its addresses. An IPv4 address is preferred to an IPv6 address. Among addresses of the same
/// kind, the first interface by name is preferred.
[[nodiscard]] std::vector<FoundServer> removeDuplicates(std::vector<FoundServer> found);

/// Returns the server that is announced as `name`, if there is exactly one. Otherwise returns
/// nullopt and writes the reason to `why`: no server, or the addresses of the servers that announce
/// `name`.
[[nodiscard]] std::optional<FoundServer> only(const std::vector<FoundServer>& found,
                                              const std::string& name, std::string& why);

/// Largest number of lines of toText(). The value is a choice: a person still reads that many
/// lines.
constexpr std::size_t kMaxListedServers = 32;

/// Returns one line for each server. If there are more than kMaxListedServers, the last line states
/// that there are more. The last line has no line end. Control characters are replaced.
[[nodiscard]] std::string toText(const std::vector<FoundServer>& servers);

}  // namespace hapticast::client
