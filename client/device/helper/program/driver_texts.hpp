// SPDX-License-Identifier: MIT
// Texts that a built-in driver returns through the C interface.
// Thread: any.
#pragma once

#include <cstring>
#include <string_view>

namespace hapticast::client {

/// Writes the reason of a failure into the buffer `why` of list() and open(), cut to 255 bytes.
inline void writeReason(std::string_view reason, char* why) {
  constexpr std::size_t kMost = 255;
  const std::size_t size = reason.copy(why, kMost);
  why[size] = '\0';
}

}  // namespace hapticast::client
