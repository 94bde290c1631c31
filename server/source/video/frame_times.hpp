// SPDX-License-Identifier: MIT
// What the times of the frames of two video files say about which frames belong together. Plain
// functions without FFmpeg. Thread: any.
#pragma once

#include <cstdint>
#include <vector>

namespace hapticast::server {

/// Times of the frames of one track.
struct FrameTimes {
  std::vector<double> times_s;  ///< since the first frame, ascending; empty: no usable times
  double start_s = 0.0;         ///< time of the first frame on the clock of the file
  double fps = 0.0;             ///< nominal rate: that of frames without a gap, frames/s
  bool has_gaps = false;        ///< whether frames of the nominal rate are missing

  [[nodiscard]] bool usable() const { return !times_s.empty(); }
  /// Returns the time from the begin of the first frame to the end of the last one, s. Requires
  /// usable().
  [[nodiscard]] double duration_s() const { return times_s.back() + 1.0 / fps; }
  /// Returns by how much a frame of another track may be earlier or later, s: half a period, and
  /// what containers round. Requires usable().
  [[nodiscard]] double tolerance_s() const { return 0.51 / fps; }
};

/// Returns what `times_s` say: the times of all frames on the clock of their file, ascending and
/// finite. The result is not usable if there are fewer than two times, if the rate is not 1 to 240
/// frames/s, or if they last longer than a million seconds.
[[nodiscard]] FrameTimes describeTimes(std::vector<double> times_s);

/// Returns whether the frames of two files belong together by their times, and not by their
/// numbers. Numbers decide in three cases. A file has no usable times. Both have the same number of
/// frames, and one of them has no gaps: a program that goes through a video frame by frame writes
/// its result at a constant rate. Neither has gaps, and the numbers of frames agree better than the
/// durations.
[[nodiscard]] bool belongByTime(const FrameTimes& color, const FrameTimes& depth);

/// Frames of one track without a frame of the other track at their time.
struct LoneFrames {
  std::uint64_t count = 0;
  double first_s = 0.0;  ///< time of the first one; 0 if there is none
};

/// Returns the frames of `times` that have no frame of `others` within `others.tolerance_s()`.
/// Requires both to be usable.
[[nodiscard]] LoneFrames findLone(const FrameTimes& times, const FrameTimes& others);

/// Returns the element of `times_s` that is nearest to `time_s`; of two the earlier one. Requires
/// `times_s` to be ascending and not empty.
[[nodiscard]] double nearestTime_s(const std::vector<double>& times_s, double time_s);

}  // namespace hapticast::server
