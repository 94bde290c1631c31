// SPDX-License-Identifier: MIT
// A payload with its length in front, as it stands on a TCP stream.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/transport/framing.hpp"

namespace hapticast::testing {

inline std::vector<std::uint8_t> framed(std::span<const std::uint8_t> payload) {
  const LengthPrefix prefix = lengthPrefix(payload.size());
  std::vector<std::uint8_t> bytes(prefix.begin(), prefix.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

}  // namespace hapticast::testing
