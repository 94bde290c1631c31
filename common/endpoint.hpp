// SPDX-License-Identifier: MIT
// Where a server listens, as people write it. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hapticast {

inline constexpr std::uint16_t kDefaultPort = 7447;

struct Endpoint {
  std::string host;  ///< a name or a numeric address, IPv6 without brackets
  std::uint16_t port = kDefaultPort;
  bool operator==(const Endpoint&) const = default;
};

/// HOST, HOST:PORT, [V6ADDRESS] or [V6ADDRESS]:PORT; nullopt if it is none of them.
[[nodiscard]] std::optional<Endpoint> parseEndpoint(std::string_view text);
/// HOST:PORT or [V6ADDRESS]:PORT, which parseEndpoint() reads back.
[[nodiscard]] std::string toString(const Endpoint& endpoint);

}  // namespace hapticast
