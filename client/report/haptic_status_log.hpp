// SPDX-License-Identifier: MIT
// What a person is told of the touch while it lasts: why there is no force, that it is back, that a
// wall is softer than meant. A line for what is new. Thread: main.
#pragma once

#include <optional>
#include <string>

#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/log_rate_limiter.hpp"

namespace hapticast::client {

class HapticStatusLog {
 public:
  /// Sees every report, before `rearm`, which knows whether the force will come back by itself.
  std::optional<std::string> onReport(const TickReport& report, const RearmPolicy& rearm);

 private:
  [[nodiscard]] std::string describeStatus(const TickReport& report);

  Halt halt_ = Halt::kNone;
  bool stale_ = false;
  bool logged_enable_ = false;  // once: whoever uses the button knows
  LogInterval softer_;
  LogInterval later_;
  LogRateLimiter limit_;
  LogRateLimiter halt_limit_;  // whatever else a stream makes the other one say
};

}  // namespace hapticast::client
