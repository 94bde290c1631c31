// SPDX-License-Identifier: MIT
// Impact detection: finds the instants at which an object's velocity jumps, as at a bounce. It
// examines each interval between two frames. One parabola fits the last three frames before the
// interval, another the first three frames after it. An impact is where the two parabolas meet with
// different velocities. Each object has a finder of its own. Thread: the one that runs Vision.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// Finds the impacts of one object and stores the newest ones.
class ImpactFinder {
 public:
  /// Number of frames to which the parabola on each side of an interval is fitted. It is at most
  /// the lookahead.
  static constexpr std::size_t kSide = 3;

  /// Searches for an impact between samples[at] and the next sample, and stores it for
  /// findAround(). It finds none if there are fewer than kSide samples up to samples[at], or fewer
  /// than kSide after it. If an impact is late in its interval, only the next call may store it.
  /// The times of `samples` are media times. Call it once for each frame in order of time.
  void test(const std::vector<Sample>& samples, std::size_t at);

  /// Returns the stored impacts at most `reach_s` before or after the media time `time_s`, oldest
  /// first. The finder stores the newest kMaxImpacts impacts.
  [[nodiscard]] std::vector<Impact> findAround(double time_s, double reach_s) const;

 private:
  struct Jump {  // change of velocity between two frames
    double time_s = 0.0;
    Vec3 delta_mm_s = Vec3::Zero();
    double middle_mm_s = 0.0;  // magnitude of the change in the middle between the frames
    double place = 0.0;        // instant of the jump: 0 at the first frame, 1 at the second
    double bend = 0.0;         // change of acceleration x frame's duration, relative to the jump
    bool clean = false;        // the parabolas meet with similar curvature
  };
  static std::optional<Jump> jumpAfter(const std::vector<Sample>& samples, std::size_t at);
  [[nodiscard]] bool exceedsNoise(const Jump& jump) const;
  void accept(const Jump& jump);

  std::deque<double> usual_mm_s_;  // changes of velocity in the last frames
  // Jump late in its interval; the next interval decides whether it counts.
  std::optional<Jump> waiting_;
  std::deque<Impact> found_;
};

}  // namespace hapticast::server
