// SPDX-License-Identifier: MIT
// Frames of a WebSocket as a client sends them (RFC 6455, section 5.2).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hapticast::testing {

/// A frame with the first byte `head` (FIN, reserved bits, opcode), masked.
inline std::vector<std::uint8_t> maskedFrame(std::uint8_t head,
                                             const std::vector<std::uint8_t>& payload,
                                             const std::array<std::uint8_t, 4>& mask = {1, 2, 3,
                                                                                        4}) {
  const std::uint64_t length = payload.size();
  const int more = length < 126 ? 0 : length <= 0xFFFF ? 2 : 8;
  std::vector<std::uint8_t> frame{head, static_cast<std::uint8_t>(0x80U | (more == 0   ? length
                                                                           : more == 2 ? 126U
                                                                                       : 127U))};
  for (int shift = 8 * (more - 1); shift >= 0; shift -= 8)
    frame.push_back(static_cast<std::uint8_t>(length >> static_cast<unsigned>(shift)));
  frame.insert(frame.end(), mask.begin(), mask.end());
  for (std::size_t i = 0; i < payload.size(); ++i)
    frame.push_back(static_cast<std::uint8_t>(payload[i] ^ mask[i % 4]));
  return frame;
}

}  // namespace hapticast::testing
