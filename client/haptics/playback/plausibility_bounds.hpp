// SPDX-License-Identifier: MIT
// Plausibility bounds: the largest motion that successive frames support. A stream's accelerations,
// turns, impacts and grids count only as far as the positions, velocities and reliefs of the frames
// around play time support them. Example: a plateau at rest with a stated acceleration of 1e8
// mm/s². The method is in client/haptics/README.md, section 4.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <limits>

#include "client/haptics/playback/frame_pool.hpp"

namespace hapticast::client {

/// Upper bounds for one object between two frames, nominal mm. The defaults are no bound.
struct PlausibilityBounds {
  double acceleration_mm_s2 = std::numeric_limits<double>::infinity();  ///< of the reference point
  /// Additional acceleration of a grid.
  double grid_mm_s2 = std::numeric_limits<double>::infinity();
  double impact_mm_s = std::numeric_limits<double>::infinity();
  double turn_rad_s = std::numeric_limits<double>::infinity();
  double turn_rate_rad_s2 = std::numeric_limits<double>::infinity();
};

/// One object in five successive frames, and the intervals between them. Frames kNow and kNow + 1
/// are around play time. An entry is null if the frame, or the object in it, is missing. Frames
/// closer together than half of 1/240 s support nothing.
struct ObjectHistory {
  static constexpr std::size_t kFrames = 5;
  static constexpr std::size_t kNow = 2;
  std::array<const PlayObject*, kFrames> object{};
  std::array<double, kFrames - 1> interval_s{};
};
/// Returns the bounds that the frames in `seen` support.
PlausibilityBounds boundsFrom(const ObjectHistory& seen) noexcept;

}  // namespace hapticast::client
