// SPDX-License-Identifier: MIT
// Estimates when the frames of a network stream were captured. Time stamps of a stream follow the
// sender's clock, without the jitter of the network. But their offset to the local clock is
// unknown. The frame with the shortest delay determines this offset. Thread: one.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace hapticast::server {

/// Capture times of one stream. The frame with the shortest delay counts as captured at its
/// arrival.
class CaptureClock {
 public:
  /// Returns the time of capture of the frame with the time stamp `stamp_s` that arrived at
  /// `arrived`. The result is at most `arrived`, and never decreases. Returns nullopt if the caller
  /// must drop the frame, because it is the first one or belongs to a burst. Frames of a burst
  /// arrive more than kEarly too early or more than kLate too late, because a buffer delayed some
  /// frames. If this lasts longer than kPatience, it is no burst, and the clock uses the new
  /// offset. If `stamp_s` is not finite, the frame counts as captured at `arrived`.
  [[nodiscard]] std::optional<LocalTime> capture(double stamp_s, LocalTime arrived);

  static constexpr Duration kEarly = std::chrono::milliseconds(10);  ///< chosen: beyond jitter
  static constexpr Duration kLate = std::chrono::milliseconds(250);  ///< as in viewers' queues
  static constexpr Duration kPatience = std::chrono::seconds(1);     ///< chosen

 private:
  /// Returns whether a frame belongs to a burst. `offset`: local time of its arrival minus its time
  /// stamp.
  bool isOfBurst(Duration offset, LocalTime arrived);

  std::optional<Duration> offset_;        // from time stamps to local time
  std::optional<LocalTime> burst_since_;  // arrival of the burst's first frame
  LocalTime last_arrived_{};
  LocalTime last_captured_{};
};

}  // namespace hapticast::server
