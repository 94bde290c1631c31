// SPDX-License-Identifier: MIT
// Keeps strangers on the port from filling the log: so many lines in a while, the rest counted.
// Thread: one.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace hapticast::server {

class LogLimit {
 public:
  static constexpr std::uint64_t kLines = 10;
  static constexpr Duration kWhile = std::chrono::seconds(10);

  /// Whether a line may be written now.
  [[nodiscard]] bool allow(LocalTime now) {
    if (lines_ == 0 || now - since_ >= kWhile) {
      since_ = now;
      lines_ = 0;
    }
    if (lines_ == kLines) {
      ++suppressed_;
      return false;
    }
    ++lines_;
    return true;
  }
  /// Lines kept back since the last call.
  [[nodiscard]] std::uint64_t takeSuppressed() {
    const std::uint64_t count = suppressed_;
    suppressed_ = 0;
    return count;
  }

 private:
  LocalTime since_{};
  std::uint64_t lines_ = 0;
  std::uint64_t suppressed_ = 0;
};

}  // namespace hapticast::server
