// SPDX-License-Identifier: MIT
// Rate limiter for a parameter of a material (stiffness, damping, friction). In contact it spreads
// a change of the parameter over 0.3 s. So a stream cannot use the parameter to strike the hand or
// to pump energy into the hand.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <algorithm>
#include <cmath>

#include "common/time.hpp"

namespace hapticast::client {

/// Limits how fast one parameter changes.
class ParameterRateLimiter {
 public:
  /// Returns the value for this tick. It approaches the requested value `wanted` at the limited
  /// rate. If `in_contact` is false, the result is `wanted`. If `wanted` is not finite, the result
  /// is `wanted` too, and the state does not change.
  double step(double wanted, bool in_contact) noexcept {
    if (!std::isfinite(wanted)) return wanted;  // the safety chain rejects it
    if (!in_contact) value_ = goal_ = wanted;
    if (wanted != goal_) {
      goal_ = wanted;
      step_ = std::abs(goal_ - value_) * (kTick_s / kChange_s);
    }
    value_ = std::clamp(goal_, value_ - step_, value_ + step_);
    return value_;
  }

 private:
  static constexpr double kChange_s = 0.3;  // a choice: too slow to drive a hand
  double value_ = 0.0;
  double goal_ = 0.0;
  double step_ = 0.0;  // per tick
};

}  // namespace hapticast::client
