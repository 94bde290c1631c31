// SPDX-License-Identifier: MIT
// How far a stream is believed: what it says of accelerations, turns and impacts only as far as
// positions, velocities and reliefs of the frames around play time bear it out. A plateau at rest
// that claims 1e8 mm/s² is a lie that one subtraction shows. Real-time room.
#pragma once

#include <array>
#include <limits>

#include "client/haptics/playback/frame_pool.hpp"

namespace hapticast::client {

/// The most that is believed of one object between two frames, nominal mm.
struct PlausibilityBounds {
  double acceleration_mm_s2 = std::numeric_limits<double>::infinity();  ///< of the reference point
  double grid_mm_s2 = std::numeric_limits<double>::infinity();          ///< that a grid adds to it
  double impact_mm_s = std::numeric_limits<double>::infinity();
  double turn_rad_s = std::numeric_limits<double>::infinity();
  double turn_rate_rad_s2 = std::numeric_limits<double>::infinity();
};

/// An object in five successive frames, of which kNow and the next are around play time (null where
/// it or the frame is not known), and the time from each to the next. Frames closer together than
/// any stream's bear nothing out.
struct ObjectHistory {
  static constexpr std::size_t kFrames = 5;
  static constexpr std::size_t kNow = 2;
  std::array<const PlayObject*, kFrames> object{};
  std::array<double, kFrames - 1> interval_s{};
};
PlausibilityBounds boundsFrom(const ObjectHistory& seen) noexcept;

}  // namespace hapticast::client
