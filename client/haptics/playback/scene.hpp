// SPDX-License-Identifier: MIT
// The scene: all objects at one instant of play time, in the form that the contact computation
// reads. Its pointers are valid until the next call of SceneInterpolator::at().
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/playback/plausibility_bounds.hpp"

namespace hapticast::client {

/// Source of the surface in this tick. kEmpty: there is no frame. kInterpolated: between two
/// frames. kExtrapolated: dead reckoning after the newest frame. kHeld: the newest frame at rest.
/// kStale: the newest frame is too old for a force.
enum class Lookup : std::uint8_t { kEmpty = 0, kInterpolated, kExtrapolated, kHeld, kStale };
inline constexpr std::size_t kLookupKinds = 5;

/// One object at play time. Its relief moves with the object. To read the relief at a point,
/// transform the point into the frame `before`, and into `after` if there is one. Then blend the
/// two values (surface_model.hpp). So the blend contains only the change of the shape, not the
/// motion.
struct InterpolatedObject {
  const PlayObject* before = nullptr;  ///< the object in the frame before play time; never null
  /// The object in the next frame. Null if the object is missing there, if there is no next frame
  /// of the same epoch soon enough, and with Interpolation::kHold.
  const PlayObject* after = nullptr;
  /// Weight of `after`. It is 0 at the time of `before` and 1 at the time of `after`. If `after`
  /// arrived late, the weight is 0 at its arrival.
  double blend = 0.0;
  double blend_rate_1_s = 0.0;      ///< rate of change of `blend`; 0 in a pause and without `after`
  bool appeared = false;            ///< the scene of the last tick did not have this id and layer
  Vec3 position_mm = Vec3::Zero();  ///< position of the reference point at play time
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;
  double angular_velocity_rad_s = 0.0;
  PlausibilityBounds plausibility;  ///< bounds for the motion that its frames state
};

/// All objects at play time.
struct Scene {
  Lookup kind = Lookup::kEmpty;
  std::uint32_t epoch = 0;  ///< epoch of the current frame
  bool jumped = false;      ///< the epoch changed since the last tick
  MediaTime play_time;
  std::array<InterpolatedObject, kMaxObjects> objects{};
  std::size_t object_count = 0;
};

}  // namespace hapticast::client
