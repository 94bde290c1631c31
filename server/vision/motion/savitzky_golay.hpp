// SPDX-License-Identifier: MIT
// Savitzky-Golay filter: position, velocity and acceleration as coefficients of a polynomial over a
// short centred window, so that the three agree with each other. Thread: any.
#pragma once

#include <vector>

#include "common/haptic_frame.hpp"
#include "common/time.hpp"

namespace hapticast::server {

/// A pose in nominal units at one frame.
struct Sample {
  double time_s = 0.0;
  Vec3 position_mm = Vec3::Zero();
  double angle_rad = 0.0;
  bool depth_seen = true;  ///< false: position_mm.z() is not a measurement
  bool seen = true;        ///< false: no value is a measurement
  bool confident = true;   ///< false: a jump to this sample may not be the object's
  /// Motion of the background at the object, accumulated; zero without pan compensation, mm.
  Vec3 background_mm = Vec3::Zero();

  /// Returns the position relative to the background.
  [[nodiscard]] Vec3 panCompensated_mm() const { return position_mm - background_mm; }
};

/// Returns the samples relative to the background; empty if the background did not move.
std::vector<Sample> panCompensated(const std::vector<Sample>& samples);

/// Returns the lookahead in frames, for a window of constant duration (7 frames at 25-30 fps, 11 at
/// 60).
int lookaheadFrames(double fps);

/// Returns position, velocity, acceleration, angle and angular velocity at samples[at]; other
/// fields of the result have their defaults. `samples`: up to `lookahead` samples on either side,
/// in order of time, without gaps.
/// The polynomial has order 4 over the whole window, and a lower order at the ends of a track. If
/// the whole window does not fit (it contains a bounce), the best shorter window is used.
/// The acceleration is relative to the background.
Motion motionFrom(const std::vector<Sample>& samples, std::size_t at, int lookahead);

}  // namespace hapticast::server
