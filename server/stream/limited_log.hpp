// SPDX-License-Identifier: MIT
// Lines of the log that somebody can cause again and again, for example with SIGHUP. Thread: one at
// a time.
#pragma once

#include <spdlog/common.h>

#include <string>

#include "common/rate_limiter.hpp"
#include "common/time.hpp"

namespace hapticast::server {

/// Logs at most 10 warnings and errors a minute, and at most 10 other lines a minute. A line after
/// others that were left out states their number.
class LimitedLog {
 public:
  /// `clock` must outlive this object.
  explicit LimitedLog(const Clock& clock) : clock_(clock) {}

  void info(std::string line);
  void warn(std::string line);
  void error(std::string line);

 private:
  void log(spdlog::level::level_enum level, std::string line);

  const Clock& clock_;
  RateLimiter problems_;  // separate, so that usual lines hide no problem
  RateLimiter others_;
};

}  // namespace hapticast::server
