// SPDX-License-Identifier: MIT
// A number of a material as it is felt: under the hand it changes within 0.3 s, so that a stream
// can neither strike nor pump with it. Real-time room.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/tick.hpp"

namespace hapticast::client {

class ParameterRateLimiter {
 public:
  /// What is felt in this tick of what the stream says. Not `in_contact` it holds at once.
  double step(double wanted, bool in_contact) noexcept {
    if (!std::isfinite(wanted)) return wanted;  // the chain's to judge, and nothing to follow
    if (!in_contact) value_ = goal_ = wanted;
    if (wanted != goal_) {
      goal_ = wanted;
      step_ = std::abs(goal_ - value_) * (kTick_s / kChange_s);
    }
    value_ = std::clamp(goal_, value_ - step_, value_ + step_);
    return value_;
  }

 private:
  static constexpr double kChange_s = 0.3;  // chosen: slower than a hand can be driven by it
  double value_ = 0.0;
  double goal_ = 0.0;
  double step_ = 0.0;  // a tick
};

}  // namespace hapticast::client
