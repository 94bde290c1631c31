// SPDX-License-Identifier: MIT
// Real-time pacing of a recorded clip: computes when each frame is due, and its media time. If the
// server is late, frames are skipped, so that the newest is processed. Callers pass all times as
// arguments: the class has no thread and no clock, and never waits. Thread: one.
#pragma once

#include <cstdint>

#include "common/time.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Plans the playback of a clip. Each frame has a slot: a media time. The slots are 1/fps apart.
/// They continue when a loop begins again, so media time always increases. For each frame:
///   plan = pacer.plan(now);  wait until plan.due;  skip plan.skip frames;  read the frame;
///   media_time = pacer.frameRead(frame.epoch, frame.index);
/// If the wait ended too late, because the machine stood still, plan() replaces the plan.
class Pacer {
 public:
  /// Instructions for the next frame.
  struct Plan {
    std::uint64_t skip = 0;  ///< frames to skip before the next frame is read
    /// Media time at which the next frame is due; before `now` if it is late.
    MediaTime due;
  };

  /// Begins a plan whose first frame is due at `start`. Requires fps > 0, frames/s.
  Pacer(double fps, MediaTime start);

  /// Returns the instructions for the frame after the last one that was read. Usually a frame is
  /// skipped if the frame after it is already due. After a delay longer than kLongestSkip (for
  /// example, a suspended machine), no frame is skipped. All later frames are then delayed instead.
  [[nodiscard]] Plan plan(MediaTime now);

  /// Returns the media time of the frame that was read for the last plan. `epoch`, `index`: those
  /// of the frame. Frames that the source itself skipped occupy slots too, so later frames keep
  /// their times.
  MediaTime frameRead(std::uint32_t epoch, std::uint64_t index);

  /// Continues after a time without playback until `now`: the next frame is due now at the
  /// earliest, and none is skipped.
  void resume(MediaTime now);

  /// Returns the number of frames skipped because they were late.
  [[nodiscard]] std::uint64_t skipped() const noexcept { return skipped_; }

  static constexpr Duration kLongestSkip = std::chrono::seconds(1);

 private:
  [[nodiscard]] MediaTime slotTime(std::uint64_t slot) const;

  double fps_;
  MediaTime start_;              // media time of slot 0
  std::uint64_t slot_ = 0;       // slot of the last planned frame
  std::uint64_t next_slot_ = 0;  // slot of the next frame if none is skipped
  std::uint64_t step_ = 1;       // frames between the last read and the planned frame
  std::uint64_t skipped_ = 0;
  bool any_read_ = false;
  std::uint32_t last_epoch_ = 0;
  std::uint64_t last_index_ = 0;
};

/// Skips `skip` frames of `source` and returns the next one, or nullopt at the end of the clip. If
/// `loop` is true, the clip begins again at its end, in a new epoch. It never skips the first frame
/// after that, because the author's points mark the objects in this frame. Throws SourceError.
/// Thread: the source's.
std::optional<RgbdFrame> readSkipping(RgbdSource& source, std::uint64_t skip, bool loop);

}  // namespace hapticast::server
