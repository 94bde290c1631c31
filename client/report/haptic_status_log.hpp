// SPDX-License-Identifier: MIT
// What a person is told of the touch while it lasts: why there is no force, that it is back, that a
// wall is softer than meant. A line for what is new. Thread: main.
#pragma once

#include <optional>
#include <string>

#include "client/haptics/rearm_policy.hpp"
#include "client/haptics/tick_report.hpp"
#include "client/report/log_rate_limiter.hpp"

namespace hapticast::client {

class TouchTeller {
 public:
  /// Sees every report, before `rearm`, which knows whether the force will come back by itself.
  std::optional<std::string> take(const TickReport& report, const Rearm& rearm);

 private:
  [[nodiscard]] std::string news(const TickReport& report);

  Halt halt_ = Halt::kNone;
  bool stale_ = false;
  bool told_enable_ = false;  // once: whoever uses the button knows
  std::optional<LocalTime> told_softer_;
  std::optional<LocalTime> told_later_;
  LineLimit limit_;
  LineLimit halt_limit_;  // whatever else a stream makes the other one say
};

}  // namespace hapticast::client
