// SPDX-License-Identifier: MIT
// Adaptive playout delay against jitter. Each frame of the last 5 s needed some delay to be in
// time. The playout delay is the 0.99 quantile of these delays, plus a margin. Times are arguments.
// Thread: one at a time (network).
#pragma once

#include <deque>

#include "common/time.hpp"

namespace hapticast::client {

/// Estimates the smallest playout delay with which frames arrive before they are due.
class JitterEstimator {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(5);
  /// Share of the frames that the delay covers. The value is a choice. At 25 frames/s, one frame of
  /// the window may need more. At a loss of 1 %, TCP delays every fiftieth frame by 200 ms, and the
  /// quantile covers those frames as well.
  static constexpr double kQuantile = 0.99;
  /// With at least this number of frames in the window, the quantile always omits the frame that
  /// needed most. The value is a choice: after an outage, the first frame is late by the whole
  /// outage.
  static constexpr std::size_t kFewFrames = 10;
  static constexpr Duration kMargin = std::chrono::milliseconds(5);
  static constexpr Duration kMaxDelay = std::chrono::seconds(2);

  /// Removes all stored frames.
  void reset() { samples_.clear(); }

  /// Adds a frame that arrived at `arrival`. `needed` is the playout delay with which the frame
  /// would be in time: its lateness plus the media time since the previous frame that arrived. The
  /// interpolation needs this frame as soon as play time passes that previous frame.
  void add(LocalTime arrival, Duration needed);
  /// Adds `by` to the delays of all stored frames. Call it after a change of the clock offset.
  void shift(Duration by);

  /// Returns the playout delay: the quantile of the window plus the margin, within [least,
  /// kMaxDelay]. In a window of at least kFewFrames frames, the quantile omits at least one.
  /// Without a frame it returns `least` plus the margin.
  [[nodiscard]] Duration delay(Duration least) const;

 private:
  struct Sample {
    LocalTime arrival;
    Duration needed;
  };
  std::deque<Sample> samples_;  // oldest first; at most kWindow long
};

}  // namespace hapticast::client
