// SPDX-License-Identifier: MIT
// Adaptive playout delay against jitter. Each frame of the last 5 s needed some delay to be in
// time. The playout delay is the 0.99 quantile of these delays, plus a margin. An outage of the
// stream, for example of a server that stood still, counts as one event, however many frames it
// delayed. The estimator leaves out a single outage. Times are arguments.
// Thread: one at a time (network).
#pragma once

#include <deque>
#include <optional>

#include "common/time.hpp"

namespace hapticast::client {

/// Arrival of a frame, by the local clock.
struct FrameArrival {
  LocalTime at;
  /// Playout delay with which the frame would be in time: its lateness plus the media time since
  /// the frame before. The interpolation needs this frame as soon as play time passes that frame.
  Duration needed;
  /// Time when the frame before would have arrived without any delay.
  LocalTime previous_due;
};

/// Estimates the smallest playout delay with which frames arrive before they are due.
class JitterEstimator {
 public:
  static constexpr Duration kWindow = std::chrono::seconds(5);
  /// Share of the frames that the delay covers. The value is a choice. At 25 frames/s, one frame of
  /// the window may need more. At a loss of 1 %, TCP delays every fiftieth frame by 200 ms, and the
  /// quantile covers those frames as well.
  static constexpr double kQuantile = 0.99;
  /// With at least this number of frames in the window, the quantile always omits the frame that
  /// needed most. The value is a choice.
  static constexpr std::size_t kFewFrames = 10;
  static constexpr Duration kMargin = std::chrono::milliseconds(5);
  static constexpr Duration kMaxDelay = std::chrono::seconds(2);
  /// An outage is a time without an arrival that is longer than this and than kOutage_intervals
  /// frame intervals. The values are a choice: TCP repeats a lost segment within 250 ms.
  static constexpr Duration kOutage = std::chrono::milliseconds(250);
  static constexpr int kOutage_intervals = 4;

  /// `max_delay`: largest delay, at most kMaxDelay.
  explicit JitterEstimator(Duration max_delay = kMaxDelay) : max_delay_(max_delay) {}

  /// Removes all stored frames. A connection begins at `now`: frames that were due before belong to
  /// an outage.
  void reset(LocalTime now);
  [[nodiscard]] Duration maxDelay() const { return max_delay_; }

  /// Adds a frame of a stream with frames of `interval`.
  void add(const FrameArrival& frame, Duration interval);
  /// Adds `by` to the delays of all stored frames. Call it after a change of the clock offset.
  void shift(Duration by);

  /// Returns the playout delay: the quantile of the window plus the margin, within [least,
  /// max_delay]. In a window of at least kFewFrames frames, the quantile omits at least one. From
  /// two outages in the window on, the delay covers all of them but the longest. Without a frame it
  /// returns `least` plus the margin.
  [[nodiscard]] Duration delay(Duration least) const;

 private:
  struct Sample {
    LocalTime arrival;
    Duration needed;
    // Present: the sample stands for all frames that the outage with this end delayed.
    std::optional<LocalTime> outage_end;
  };
  /// Returns the end of the outage that delayed `frame`; nullopt if none did.
  [[nodiscard]] std::optional<LocalTime> findOutage(const FrameArrival& frame, Duration interval);
  /// Returns the second largest delay of the outages in the window; nullopt if there is no second.
  [[nodiscard]] std::optional<Duration> findSecondOutage() const;

  Duration max_delay_;
  std::deque<Sample> samples_;  // oldest first; at most kWindow long
  std::optional<LocalTime> last_arrival_;
  std::optional<LocalTime> outage_end_;  // of the last outage
};

}  // namespace hapticast::client
