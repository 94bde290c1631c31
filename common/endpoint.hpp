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

/// HOST, HOST:PORT, PORT or :PORT, an IPv6 address as [ADDRESS], [ADDRESS]:PORT or bare; nullopt if
/// it is none of them. What is not said is taken from `otherwise`.
[[nodiscard]] std::optional<Endpoint> parseEndpoint(std::string_view text,
                                                    const Endpoint& otherwise);
/// Whether the host is a numeric address of IPv6.
[[nodiscard]] bool isV6(const Endpoint& endpoint);
/// HOST:PORT or [V6ADDRESS]:PORT, which parseEndpoint() reads back.
[[nodiscard]] std::string toString(const Endpoint& endpoint);

}  // namespace hapticast
