// SPDX-License-Identifier: MIT
// Network endpoint of a server: parser and formatter. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hapticast {

inline constexpr std::uint16_t kDefaultPort = 7447;

/// Address of a server.
struct Endpoint {
  std::string host;  ///< name or numeric address, IPv6 without brackets
  std::uint16_t port = kDefaultPort;
  bool operator==(const Endpoint&) const = default;
};

/// Parses HOST, HOST:PORT, PORT or :PORT; an IPv6 address as [ADDRESS], [ADDRESS]:PORT or bare.
/// Missing parts are those of `otherwise`. nullopt for other texts.
[[nodiscard]] std::optional<Endpoint> parseEndpoint(std::string_view text,
                                                    const Endpoint& otherwise);
/// Returns whether the host is a numeric IPv6 address.
[[nodiscard]] bool isV6(const Endpoint& endpoint);
/// Formats HOST:PORT or [V6ADDRESS]:PORT, which parseEndpoint() accepts.
[[nodiscard]] std::string toString(const Endpoint& endpoint);

}  // namespace hapticast
