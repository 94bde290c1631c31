// SPDX-License-Identifier: MIT
// Network endpoint of a server (host and port), as text and as a value. Thread: any.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hapticast {

inline constexpr std::uint16_t kDefaultPort = 7447;

/// Host and port of a server.
struct Endpoint {
  std::string host;  ///< name or numeric address; an IPv6 address has no brackets here
  std::uint16_t port = kDefaultPort;
  bool operator==(const Endpoint&) const = default;
};

/// Returns the endpoint in `text`, which has the form HOST, HOST:PORT, PORT or :PORT. An IPv6
/// address has the form [ADDRESS], [ADDRESS]:PORT, or ADDRESS alone. `otherwise` provides a
/// missing part. Returns nullopt for other texts.
[[nodiscard]] std::optional<Endpoint> parseEndpoint(std::string_view text,
                                                    const Endpoint& otherwise);
/// Returns true if the host is a numeric IPv6 address.
[[nodiscard]] bool isV6(const Endpoint& endpoint);
/// Returns the text HOST:PORT or [V6ADDRESS]:PORT. parseEndpoint() accepts both.
[[nodiscard]] std::string toString(const Endpoint& endpoint);

}  // namespace hapticast
