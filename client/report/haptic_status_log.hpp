// SPDX-License-Identifier: MIT
// Log lines about the force during a run: a halt and its cause, the return of the force, a softer
// wall. One line for each change.
// Thread: main.
#pragma once

#include <optional>
#include <string>

#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/log_rate_limiter.hpp"

namespace hapticast::client {

/// State of the lines about the force.
class HapticStatusLog {
 public:
  /// Processes every report in order and returns a line if there is something new. Call it before
  /// rearm.onReport(): `rearm` states whether re-arming is automatic.
  std::optional<std::string> onReport(const TickReport& report, const RearmPolicy& rearm);

 private:
  [[nodiscard]] std::string describeStatus(const TickReport& report);

  Halt halt_ = Halt::kNone;
  bool stale_ = false;
  bool logged_enable_ = false;  // logged once a run
  LogInterval softer_;
  LogInterval later_;
  LogRateLimiter limit_;
  LogRateLimiter halt_limit_;  // separate, so that a stream cannot suppress lines about a halt
};

}  // namespace hapticast::client
