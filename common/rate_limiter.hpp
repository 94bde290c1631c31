// SPDX-License-Identifier: MIT
// Rate limiter: the generic cell rate algorithm, which is equivalent to a token bucket. Each event
// delays the time at which all tokens are back by `refill`. An event is admitted if that time is
// then at most `burst` x `refill` away. So it admits `burst` events at once, and one more after
// each `refill`. The default arguments limit the log lines about a peer. Thread: one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/time.hpp"

namespace hapticast {

/// Limiter for one kind of event.
class RateLimiter {
 public:
  /// Limit of log lines about a peer. Chosen: at most 10 lines in a minute.
  static constexpr std::int64_t kLogBurst = 6;
  static constexpr Duration kLogRefill = std::chrono::seconds(15);
  /// Limit of log lines that repeat one fact: one in a minute.
  static RateLimiter makeOnceAMinute() { return {1, std::chrono::minutes(1)}; }

  /// Requires: `burst` >= 1, `refill` > 0.
  RateLimiter(std::int64_t burst = kLogBurst, Duration refill = kLogRefill)
      : burst_(burst), refill_(refill) {}

  /// Returns true if allow(now) would.
  [[nodiscard]] bool isReady(LocalTime now) const {
    return std::max(full_, now) - now <= (burst_ - 1) * refill_;
  }
  /// Admits an event at `now` and returns true, or counts it as dropped and returns false.
  [[nodiscard]] bool allow(LocalTime now) {
    if (!isReady(now)) {
      ++dropped_;
      return false;
    }
    full_ = std::max(full_, now) + refill_;
    return true;
  }
  /// Returns `line` if it is admitted, and appends the number of lines that were dropped before it.
  /// Otherwise drops the line and returns nullopt.
  [[nodiscard]] std::optional<std::string> admit(std::string line, LocalTime now) {
    if (!allow(now)) return std::nullopt;
    const std::uint64_t dropped = popDropped();
    if (dropped > 0) line += " (and " + std::to_string(dropped) + " lines more, not shown)";
    return line;
  }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// Returns the number of dropped events since the last call.
  [[nodiscard]] std::uint64_t popDropped() { return std::exchange(dropped_, 0); }

 private:
  std::int64_t burst_;
  Duration refill_;
  LocalTime full_{};  // all tokens are back
  std::uint64_t dropped_ = 0;
};

}  // namespace hapticast
