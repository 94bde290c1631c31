// SPDX-License-Identifier: MIT
// Plays a recorded clip in real time: when the next frame is due, what to leave out when processing
// cannot keep up (newest wins), and the media time of each frame. Times are arguments; no thread,
// no clock, no waiting of its own. Thread: one.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace hapticast::server {

/// The schedule is a comb of slots 1/fps apart that knows no clip: slots count on over loop wraps,
/// so media time always increases. Use, per frame:
///   plan = pacer.plan(now);  pass over plan.skip frames;  wait until plan.due;  read the frame;
///   media_time = pacer.frameRead(frame.epoch, frame.index);
class Pacer {
 public:
  struct Plan {
    std::uint64_t skip = 0;  ///< frames to pass over first
    MediaTime due;  ///< when the frame after them is captured; not later than `now` if late
  };

  /// The first frame is due at `start`. Requires 0 < fps.
  Pacer(double fps, MediaTime start);

  /// What to play next. A frame is left out when the one after it is already due. A stall longer
  /// than kLongestSkip (a suspended machine, a debugger) is not caught up: the schedule moves
  /// instead.
  [[nodiscard]] Plan plan(MediaTime now);

  /// Media time of the frame that was read for the last plan. Frames that the source itself passed
  /// over because they were unreadable (a gap in `index` within an epoch) take up their slots too.
  MediaTime frameRead(std::uint32_t epoch, std::uint64_t index);

  /// Frames left out so far because they were late.
  [[nodiscard]] std::uint64_t skipped() const noexcept { return skipped_; }

  static constexpr Duration kLongestSkip = std::chrono::seconds(1);

 private:
  [[nodiscard]] MediaTime slotTime(std::uint64_t slot) const;

  double fps_;
  MediaTime start_;              // of slot 0
  std::uint64_t slot_ = 0;       // of the frame planned last
  std::uint64_t next_slot_ = 0;  // of the next frame if nothing is left out
  std::uint64_t step_ = 1;       // how many frames further the planned one is than the last read
  std::uint64_t skipped_ = 0;
  bool any_read_ = false;
  std::uint32_t last_epoch_ = 0;
  std::uint64_t last_index_ = 0;
};

}  // namespace hapticast::server
