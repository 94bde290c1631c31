// SPDX-License-Identifier: MIT
// An input of a fuzz target as a script: a byte says what comes, more bytes what is in it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace hapticast::fuzz {

struct Script {
  std::span<const std::uint8_t> rest;

  /// Removes and returns the next byte; 0 at the end.
  int byte() {
    if (rest.empty()) return 0;
    const int value = rest.front();
    rest = rest.subspan(1);
    return value;
  }
  /// Removes and returns the next bytes. Two bytes in front of them are their number.
  std::span<const std::uint8_t> bytes() {
    const int low = byte();
    const auto size = static_cast<std::size_t>(low + 256 * byte());
    const auto removed = rest.first(std::min(size, rest.size()));
    rest = rest.subspan(removed.size());
    return removed;
  }
};

}  // namespace hapticast::fuzz
