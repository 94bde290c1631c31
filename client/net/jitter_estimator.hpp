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
  /// Chosen: of 25 frames/s one in the window may come later. A lost packet of TCP holds up every
  /// fiftieth frame where one in a hundred is lost, and by 200 ms: play time waits for those, too.
  static constexpr double kQuantile = 0.99;
  static constexpr Duration kMargin = std::chrono::milliseconds(5);
  static constexpr Duration kMaxDelay = std::chrono::seconds(2);

  void reset() { samples_.clear(); }

  /// A frame arrived that was first needed at playout delays up to `needed`: its lateness plus the
  /// media time by which the interpolation looks ahead to it (so skipped frames count).
  void add(LocalTime arrival, Duration needed);
  /// The clock by which all of it was judged late has moved.
  void shift(Duration by);

  /// Quantile of the window + margin, within [least, kMaxDelay]; least + margin before any frame.
  [[nodiscard]] Duration delay(Duration least) const;

 private:
  struct Sample {
    LocalTime arrival;
    Duration needed;
  };
  std::deque<Sample> samples_;  // oldest first; at most kWindow long
};

}  // namespace hapticast::client
