// SPDX-License-Identifier: MIT
// Not more lines than a person can read, whatever happens. Thread: one.
#pragma once

#include <optional>
#include <string>

#include "common/time.hpp"

namespace hapticast::client {

class LogRateLimiter {
 public:
  static constexpr Duration kWhile = std::chrono::minutes(1);
  /// Chosen: as many lines a while, beyond which what comes and goes is only noise.
  static constexpr int kLines = 12;

  /// The line, the last one of this while with a word about it; nothing when there were enough.
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
