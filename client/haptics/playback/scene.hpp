// SPDX-License-Identifier: MIT
// The scene: the touchable objects at one instant of play time. Plain values; the pointers are
// valid until the next SceneInterpolator::at().
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/playback/plausibility_bounds.hpp"

namespace hapticast::client {

/// Source of this tick's surface: two frames, dead reckoning, the last frame at rest, or a stale
/// frame.
enum class Lookup : std::uint8_t { kEmpty = 0, kInterpolated, kExtrapolated, kHeld, kStale };
inline constexpr std::size_t kLookupKinds = 5;

/// One object at play time. The relief moves with the object. Sample `before` and `after` at the
/// point carried back into each frame, and blend only the change of shape (surface_model.hpp).
struct InterpolatedObject {
  const PlayObject* before = nullptr;  ///< never null
  const PlayObject* after = nullptr;   ///< null: at rest, extrapolated, or not in the next frame
  double blend = 0.0;  ///< 0 at `before` (or at the arrival of a late `after`), 1 at `after`
  double blend_rate_1_s = 0.0;      ///< d blend / dt; 0 in a pause and without `after`
  bool appeared = false;            ///< not in the scene of the last tick (by id and layer)
  Vec3 position_mm = Vec3::Zero();  ///< reference point at play time
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;
  double angular_velocity_rad_s = 0.0;
  PlausibilityBounds plausibility;  ///< for the statements of its frames
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
