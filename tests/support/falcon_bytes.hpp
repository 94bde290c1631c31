// SPDX-License-Identifier: MIT
// The Falcon's own side of its frames: what it reads, what it says.
#pragma once

#include <optional>

#include "client/device/falcon/protocol.hpp"

namespace hapticast::testing {

inline client::FalconFrame encodeReply(const client::FalconReply& reply) {
  client::FalconFrame frame{};
  frame[0] = '<';
  for (std::size_t i = 0; i < 12; ++i) {
    const auto bits = static_cast<std::uint16_t>(reply.encoders[i / 4]);
    frame[1 + i] = static_cast<std::uint8_t>('A' + (bits >> (4 * (i % 4)) & 0x0FU));
  }
  frame[13] = static_cast<std::uint8_t>('A' + (reply.buttons | reply.homed << 4U));
  frame[14] = 'A';
  frame[15] = '>';
  return frame;
}

/// None: the device would not take it for a frame.
inline std::optional<client::FalconRequest> decodeRequest(const client::FalconFrame& frame) {
  if (frame[0] != '<' || frame[15] != '>') return std::nullopt;
  client::FalconRequest request;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    unsigned bits = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint8_t byte = frame[1 + 4 * axis + i];
      if (byte < 'A' || byte > 'P') return std::nullopt;
      bits |= static_cast<unsigned>(byte - 'A') << (4 * i);
    }
    request.motors[axis] = static_cast<std::int16_t>(bits);
  }
  if (frame[13] < 'A') return std::nullopt;
  const auto flags = static_cast<std::uint8_t>(frame[13] - 'A');
  request.homing = (flags & 1U) != 0;
  request.lights = flags & 0x0EU;
  return request;
}

}  // namespace hapticast::testing
