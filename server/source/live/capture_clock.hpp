// SPDX-License-Identifier: MIT
// Estimates when the frames of a network stream were captured. Their time stamps have the pace of
// the sender without the jitter of the network, but another zero. Thread: one.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace hapticast::server {

/// Clock of the captures of one stream. The quickest frame counts as captured when it arrived.
class CaptureClock {
 public:
  /// Returns the time of capture of the frame with the time stamp `stamp_s` that arrived at
  /// `arrived`. It is at most `arrived`, and never before that of an earlier frame. Returns nullopt
  /// if the frame must be left out: it is the first one, or it belongs to a burst. In a burst,
  /// frames come by more than kEarly too early or by more than kLate too late, because they waited
  /// somewhere. What lasts longer than kPatience is no burst but the sender's new pace. A stamp
  /// that is not finite counts as one of `arrived`.
  [[nodiscard]] std::optional<LocalTime> capture(double stamp_s, LocalTime arrived);

  static constexpr Duration kEarly = std::chrono::milliseconds(10);  ///< chosen: beyond jitter
  static constexpr Duration kLate = std::chrono::milliseconds(250);  ///< as in viewers' queues
  static constexpr Duration kPatience = std::chrono::seconds(1);     ///< chosen

 private:
  /// Returns whether a frame belongs to a burst. `offset`: from its time stamp to local time.
  bool isOfBurst(Duration offset, LocalTime arrived);

  std::optional<Duration> offset_;        // from time stamps to local time
  std::optional<LocalTime> burst_since_;  // arrival of the burst's first frame
  LocalTime last_arrived_{};
  LocalTime last_captured_{};
};

}  // namespace hapticast::server
