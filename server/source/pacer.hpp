// SPDX-License-Identifier: MIT
// Real-time pacing of a recorded clip: computes the due time and media time of each frame, and
// frame drops under overload (newest wins). Times are arguments: no thread, no clock, no waiting.
// Thread: one.
#pragma once

#include <cstdint>

#include "common/time.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// The schedule is a sequence of slots 1/fps apart. Slots continue over loop wraps, so media time
/// always increases. Use for each frame:
///   plan = pacer.plan(now);  skip plan.skip frames;  wait until plan.due;  read the frame;
///   media_time = pacer.frameRead(frame.epoch, frame.index);
class Pacer {
 public:
  /// Instructions for the next frame.
  struct Plan {
    std::uint64_t skip = 0;  ///< frames to skip first
    MediaTime due;           ///< capture time of the next frame; at most `now` if late
  };

  /// The first frame is due at `start`. Requires fps > 0, frames/s.
  Pacer(double fps, MediaTime start);

  /// Plans the next frame. A frame is skipped if the frame after it is already due. After a stall
  /// longer than kLongestSkip (a suspended machine, a debugger) the schedule moves instead.
  [[nodiscard]] Plan plan(MediaTime now);

  /// Returns the media time of the frame read for the last plan. Frames that the source itself
  /// skipped (a gap in `index` within an epoch) occupy their slots too.
  MediaTime frameRead(std::uint32_t epoch, std::uint64_t index);

  /// Returns the number of frames skipped because they were late.
  [[nodiscard]] std::uint64_t skipped() const noexcept { return skipped_; }

  static constexpr Duration kLongestSkip = std::chrono::seconds(1);

 private:
  [[nodiscard]] MediaTime slotTime(std::uint64_t slot) const;

  double fps_;
  MediaTime start_;              // of slot 0
  std::uint64_t slot_ = 0;       // of the last planned frame
  std::uint64_t next_slot_ = 0;  // of the next frame without skips
  std::uint64_t step_ = 1;       // frames between the last read and the planned frame
  std::uint64_t skipped_ = 0;
  bool any_read_ = false;
  std::uint32_t last_epoch_ = 0;
  std::uint64_t last_index_ = 0;
};

// Loop playback of a clip. Thread: the source's.

/// Skips `skip` frames and reads the next. At the clip's end it rewinds (a new epoch) if `loop`.
/// The first frame of a round is never skipped, because objects start in it at the author's points.
/// Returns nullopt at the end of the clip. Throws SourceError.
std::optional<RgbdFrame> readSkipping(RgbdSource& source, std::uint64_t skip, bool loop);

}  // namespace hapticast::server
