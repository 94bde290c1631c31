// SPDX-License-Identifier: MIT
// Adaptive playout delay: a quantile of the lateness of the last 5 s of frames, plus a margin.
// Times are arguments.
// Thread: one at a time (network).
#pragma once

#include <deque>

#include "common/time.hpp"

namespace hapticast::client {

/// Estimates the delay of play time behind the media clock, so that frames arrive before they are
/// due.
class JitterEstimator {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(5);
  /// Chosen: at 25 frames/s one frame of the window may be later. TCP delays every fiftieth frame
  /// by 200 ms at a loss of 1 %; the quantile covers those frames as well.
  static constexpr double kQuantile = 0.99;
  static constexpr Duration kMargin = std::chrono::milliseconds(5);
  static constexpr Duration kMaxDelay = std::chrono::seconds(2);

  void reset() { samples_.clear(); }

  /// Adds a frame. `needed` is the largest playout delay at which the frame was late: its lateness,
  /// plus the media time of the interpolation's lookahead (so that skipped frames count).
  void add(LocalTime arrival, Duration needed);
  /// Adds `by` to all samples, after a change of the clock offset.
  void shift(Duration by);

  /// Returns the quantile of the window + margin, within [least, kMaxDelay]. Without a frame: least
  /// + margin.
  [[nodiscard]] Duration delay(Duration least) const;

 private:
  struct Sample {
    LocalTime arrival;
    Duration needed;
  };
  std::deque<Sample> samples_;  // oldest first; at most kWindow long
};

}  // namespace hapticast::client
