// SPDX-License-Identifier: MIT
// Rate limits for log lines, so that no peer can fill the log. LogRateLimiter is a token bucket: it
// starts with kBurst tokens, each line uses one, and a new one is added every kRefill. It counts
// the lines that it drops. LogInterval allows one line about a subject in each interval. Thread:
// one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "common/time.hpp"

namespace hapticast {

class LogRateLimiter {
 public:
  /// Number of tokens at the start, and time between two new tokens. The values are a choice: they
  /// allow at most 10 lines in a minute.
  static constexpr std::int64_t kBurst = 6;
  static constexpr Duration kRefill = std::chrono::seconds(15);

  /// Returns true if a token is available at `now`.
  [[nodiscard]] bool isReady(LocalTime now) {
    const std::int64_t tokens = (now - refilled_) / kRefill;
    refilled_ += tokens * kRefill;
    tokens_ = std::min(kBurst, tokens_ + tokens);
    return tokens_ > 0;
  }
  /// Uses a token and returns true. If there is none, counts a dropped line and returns false.
  [[nodiscard]] bool allow(LocalTime now) {
    if (!isReady(now)) {
      ++dropped_;
      return false;
    }
    --tokens_;
    return true;
  }
  /// Returns `line` if a token is available, and appends the number of lines that were dropped
  /// before it. Otherwise drops the line and returns nullopt.
  [[nodiscard]] std::optional<std::string> admit(std::string line, LocalTime now) {
    if (!allow(now)) return std::nullopt;
    const std::uint64_t dropped = popDropped();
    if (dropped > 0) line += " (and " + std::to_string(dropped) + " lines more, not shown)";
    return line;
  }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// Returns the number of dropped lines since the last call.
  [[nodiscard]] std::uint64_t popDropped() {
    const std::uint64_t count = dropped_;
    dropped_ = 0;
    return count;
  }

 private:
  LocalTime refilled_{};  // time of the last token
  std::int64_t tokens_ = kBurst;
  std::uint64_t dropped_ = 0;
};

class LogInterval {
 public:
  explicit LogInterval(Duration interval = std::chrono::minutes(1)) : interval_(interval) {}

  /// Returns true if no line was logged within the interval before `now`.
  [[nodiscard]] bool isDue(LocalTime now) const { return !last_ || now - *last_ >= interval_; }
  void onLogged(LocalTime now) { last_ = now; }
  /// Returns isDue(now). If the result is true, the call also registers a line at `now`.
  [[nodiscard]] bool allow(LocalTime now) {
    if (!isDue(now)) return false;
    onLogged(now);
    return true;
  }

 private:
  Duration interval_;
  std::optional<LocalTime> last_;
};

}  // namespace hapticast
