// SPDX-License-Identifier: MIT
// Bounces as events: where two parabolas, through three frames before and three after, meet with
// different velocities. One finder per object. Thread: vision's.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

class ImpactFinder {
 public:
  static constexpr std::size_t kSide = 3;  ///< frames on either side, within the lookahead

  /// Tests the interval from samples[at] to the next one. Call once per frame in order of time,
  /// with the samples around it (media time in s); without kSide samples up to `at` and kSide after
  /// it nothing is found.
  void test(const std::vector<Sample>& samples, std::size_t at);

  /// The newest impacts found at most `reach_s` before or after `time_s`, oldest first.
  [[nodiscard]] std::vector<Impact> around(double time_s, double reach_s) const;

 private:
  struct Jump {  // of velocity, between two frames
    double time_s = 0.0;
    Vec3 delta_mm_s = Vec3::Zero();
    double middle_mm_s = 0.0;  // its size taken in the middle between the frames
    double place = 0.0;        // 0 at the first frame, 1 at the second
    double bend = 0.0;         // change of acceleration over a frame, share of the jump
    bool clean = false;        // the parabolas meet, and bend alike
  };
  static std::optional<Jump> jumpAfter(const std::vector<Sample>& samples, std::size_t at);
  [[nodiscard]] bool aboveNoise(const Jump& jump) const;
  void accept(const Jump& jump);

  std::deque<double> usual_mm_s_;  // of the last frames
  std::optional<Jump> waiting_;    // so close to its second frame that the next interval decides
  std::deque<Impact> found_;
};

}  // namespace hapticast::server
