// SPDX-License-Identifier: MIT
// Savitzky-Golay filter: computes position, velocity and acceleration of an object at one frame.
// All three are derivatives of one polynomial over a short window of frames, so they are
// consistent. Thread: any.
#pragma once

#include <vector>

#include "common/haptic_frame.hpp"
#include "common/time.hpp"

namespace hapticast::server {

/// Pose of an object in one frame, in nominal mm.
struct Sample {
  double time_s = 0.0;
  Vec3 position_mm = Vec3::Zero();
  double angle_rad = 0.0;
  bool depth_seen = true;  ///< false: position_mm.z() was not measured in this frame
  bool seen = true;        ///< false: no value was measured in this frame
  bool confident = true;   ///< false: a jump to this sample may be an error of the measurement
  /// Sum of the background's motion at the object since its track began, mm; 0 without pan
  /// compensation.
  Vec3 background_mm = Vec3::Zero();

  /// Returns the position relative to the background.
  [[nodiscard]] Vec3 panCompensated_mm() const { return position_mm - background_mm; }
};

/// Returns the samples with positions relative to the background. Returns an empty list if the
/// background did not move.
std::vector<Sample> compensatePan(const std::vector<Sample>& samples);

/// Returns the lookahead for `fps` frames/s: frames on each side of a window, 3..20. Within that
/// range it lasts about 85 ms: 3 frames at 25-30 fps, 5 at 60. A window has 2 * lookahead + 1.
int lookaheadFrames(double fps);

/// Returns position, velocity, acceleration, angle and angular velocity at samples[at]. Other
/// fields of the result have their defaults. The acceleration is relative to the background.
/// `samples` are in order of time. The window has up to `lookahead` samples on either side. The
/// polynomial has order 4 over a whole window, and a lower order at the ends of a track. If the
/// polynomial does not fit the whole window, for example because of a bounce, the function uses the
/// best shorter window.
Motion computeMotion(const std::vector<Sample>& samples, std::size_t at, int lookahead);

}  // namespace hapticast::server
