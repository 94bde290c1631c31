// SPDX-License-Identifier: MIT
// Keeps strangers on the port from filling the log: a token bucket, what is kept back is counted.
// At most 10 lines a minute, whatever comes. Thread: one.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/time.hpp"

namespace hapticast::server {

class ServerLogLimiter {
 public:
  static constexpr std::int64_t kLines = 6;  ///< at once, after quiet minutes
  static constexpr Duration kRefill = std::chrono::seconds(15);

  /// Whether there is a line left to write.
  [[nodiscard]] bool refill(LocalTime now) {
    const std::int64_t lines = (now - since_) / kRefill;
    since_ += lines * kRefill;
    left_ = std::min(kLines, left_ + lines);
    return left_ > 0;
  }
  /// Whether a line may be written now, which takes one; otherwise it counts as kept back.
  [[nodiscard]] bool allow(LocalTime now) {
    if (!refill(now)) {
      ++suppressed_;
      return false;
    }
    --left_;
    return true;
  }
  [[nodiscard]] std::uint64_t suppressed() const { return suppressed_; }
  /// Lines kept back since the last call.
  [[nodiscard]] std::uint64_t popSuppressed() {
    const std::uint64_t count = suppressed_;
    suppressed_ = 0;
    return count;
  }

 private:
  LocalTime since_{};  // when the last line was earned
  std::int64_t left_ = kLines;
  std::uint64_t suppressed_ = 0;
};

}  // namespace hapticast::server
