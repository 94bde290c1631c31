// SPDX-License-Identifier: MIT
// Handshake of a WebSocket (RFC 6455, section 4.2.2). Thread: any.
#pragma once

#include <string>
#include <string_view>

namespace hapticast::server {

/// Returns whether `key` is a valid Sec-WebSocket-Key: 16 bytes in base64.
[[nodiscard]] bool isWebSocketKey(std::string_view key);
/// Returns the value of Sec-WebSocket-Accept for a Sec-WebSocket-Key.
[[nodiscard]] std::string acceptWebSocketKey(std::string_view key);

}  // namespace hapticast::server
