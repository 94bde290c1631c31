// SPDX-License-Identifier: MIT
// How long play time has to trail the media clock so that frames are there when they are due. Pure:
// times are arguments. Thread: one (network).
#pragma once

#include <deque>

#include "common/time.hpp"

namespace hapticast::client {

class JitterEstimator {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(5);
  static constexpr double kQuantile = 0.95;
  static constexpr Duration kMargin = std::chrono::milliseconds(5);
  static constexpr Duration kMaxDelay = std::chrono::seconds(2);

  void reset() { samples_.clear(); }

  /// A frame arrived `lateness` after it was complete at the server (may be negative by the clock's
  /// error).
  void add(LocalTime arrival, Duration lateness);

  /// Quantile of the window + margin + `intervals` frame intervals (what the interpolation looks
  /// ahead), within [intervals * frame_interval, kMaxDelay].
  [[nodiscard]] Duration delay(Duration frame_interval, int intervals) const;

 private:
  struct Sample {
    LocalTime arrival;
    Duration lateness;
  };
  std::deque<Sample> samples_;  // oldest first; at most kWindow long
};

}  // namespace hapticast::client
