// SPDX-License-Identifier: MIT
// Plausibility bounds: the largest motion of an object that its successive frames support. A stream
// states accelerations, rotations, impacts and motion grids. The client uses these values only as
// far as the positions, velocities and reliefs of the frames around play time support them. Example
// of a statement without support: a plateau at rest with an acceleration of 1e8 mm/s². The method
// is in client/haptics/playback/README.md.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <limits>

#include "client/haptics/playback/frame_pool.hpp"

namespace hapticast::client {

/// Upper bounds for the motion of one object between two frames, in nominal mm. The defaults do not
/// limit anything.
struct PlausibilityBounds {
  /// Acceleration of the reference point.
  double acceleration_mm_s2 = std::numeric_limits<double>::infinity();
  /// Acceleration that the motion grid may add.
  double grid_mm_s2 = std::numeric_limits<double>::infinity();
  double impact_mm_s = std::numeric_limits<double>::infinity();
  double turn_rad_s = std::numeric_limits<double>::infinity();
  double turn_rate_rad_s2 = std::numeric_limits<double>::infinity();
};

/// One object in five successive frames, and the intervals between the frames. Play time lies
/// between the frames kNow and kNow + 1. An entry of `object` is null if the frame is missing, or
/// if the object is missing in it. An interval shorter than 1/480 s supports no motion.
struct ObjectHistory {
  static constexpr std::size_t kFrames = 5;
  static constexpr std::size_t kNow = 2;
  std::array<const PlayObject*, kFrames> object{};
  std::array<double, kFrames - 1> interval_s{};
};
/// Returns the largest motion between the frames kNow and kNow + 1 that the frames of `seen`
/// support.
PlausibilityBounds computePlausibilityBounds(const ObjectHistory& seen) noexcept;

}  // namespace hapticast::client
