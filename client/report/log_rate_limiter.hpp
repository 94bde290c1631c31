// SPDX-License-Identifier: MIT
// Rate limiter for log lines: a fixed window of one minute.
// Thread: one.
#pragma once

#include <optional>
#include <string>

#include "common/time.hpp"

namespace hapticast::client {

class LogRateLimiter {
 public:
  static constexpr Duration kWhile = std::chrono::minutes(1);
  /// Lines per window. Chosen: more lines are noise.
  static constexpr int kLines = 12;

  /// Returns `line`, with a note if it is the last one of the window; nullopt above the limit.
  std::optional<std::string> allow(std::string line, LocalTime now) {
    if (lines_ == 0 || now - while_began_ >= kWhile) {
      while_began_ = now;
      lines_ = 0;
    }
    if (lines_ == kLines) return std::nullopt;
    if (++lines_ == kLines) line += " (that is all of it for a minute)";
    return line;
  }

 private:
  LocalTime while_began_{};
  int lines_ = 0;  // since while_began_
};

}  // namespace hapticast::client
