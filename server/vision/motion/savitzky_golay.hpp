// SPDX-License-Identifier: MIT
// Velocity and acceleration as the change of position over a short centred window (Savitzky-Golay).
// One window gives p, v and a, so that they agree with each other. Thread: any; values.
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
  bool depth_seen = true;  ///< false: position_mm.z() is no measurement
  bool seen = true;        ///< false: none of it is
  bool confident = true;   ///< false: a jump to here may not be the object's
  /// How far the background has moved where the object is, since some instant; zero unless the
  /// camera's pan is to be compensated.
  Vec3 background_mm = Vec3::Zero();

  /// Where it would be seen by a camera that does not pan.
  [[nodiscard]] Vec3 panCompensated_mm() const { return position_mm - background_mm; }
};

/// The samples as a camera that does not pan would have seen them; empty where it did not.
std::vector<Sample> panCompensated(const std::vector<Sample>& samples);

/// Frames of lookahead: a window constant in time (7 frames at 25-30 fps, 11 at 60).
int lookaheadFrames(double fps);

/// Position, velocity, acceleration, angle and angular velocity at samples[at]. `samples`: up to
/// the lookahead on either side, in order of time, without gaps. Order 4 over the whole window; at
/// the ends of a track a shorter window of lower order. Where the whole window does not fit (a
/// bounce in it) the best of the windows on one side or shortened ones is taken. The acceleration
/// is that against the background. Other fields of the result keep their defaults.
Motion motionFrom(const std::vector<Sample>& samples, std::size_t at, int lookahead);

}  // namespace hapticast::server
