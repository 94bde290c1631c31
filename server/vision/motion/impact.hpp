// SPDX-License-Identifier: MIT
// Impact detection: extrapolates one parabola through three frames before and one through three
// frames after an interval. An impact is where the two meet with different velocities.
// One finder for each object. Thread: the one that runs Vision.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// Impacts of one object.
class ImpactFinder {
 public:
  static constexpr std::size_t kSide = 3;  ///< frames on either side, at most the lookahead

  /// Tests the interval from samples[at] to the next sample. Call once for each frame in order of
  /// time; `time_s` of the samples is media time. Finds nothing without kSide samples up to `at`
  /// and kSide samples after it.
  void test(const std::vector<Sample>& samples, std::size_t at);

  /// Returns the newest impacts at most `reach_s` before or after `time_s`, oldest first; at most
  /// kMaxImpacts.
  [[nodiscard]] std::vector<Impact> around(double time_s, double reach_s) const;

 private:
  struct Jump {  // change of velocity between two frames
    double time_s = 0.0;
    Vec3 delta_mm_s = Vec3::Zero();
    double middle_mm_s = 0.0;  // magnitude of the change in the middle between the frames
    double place = 0.0;        // 0 at the first frame, 1 at the second
    double bend = 0.0;         // change of acceleration over a frame, relative to the jump
    bool clean = false;        // the parabolas meet with similar curvature
  };
  static std::optional<Jump> jumpAfter(const std::vector<Sample>& samples, std::size_t at);
  [[nodiscard]] bool aboveNoise(const Jump& jump) const;
  void accept(const Jump& jump);

  std::deque<double> usual_mm_s_;  // jumps of the last frames
  std::optional<Jump> waiting_;    // late in its interval; the next interval decides
  std::deque<Impact> found_;
};

}  // namespace hapticast::server
