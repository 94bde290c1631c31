// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "common/transport/datagram.hpp"

namespace hapticast::testing {

/// A datagram as it goes to whose token this is.
inline std::vector<std::uint8_t> datagramBytes(std::uint64_t token,
                                               const std::vector<std::uint8_t>& body) {
  const TokenBytes front = tokenBytes(token);
  std::vector<std::uint8_t> bytes(front.begin(), front.end());
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

}  // namespace hapticast::testing
