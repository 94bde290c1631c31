// SPDX-License-Identifier: MIT
// What can be touched at one instant of play time. Plain values; the pointers hold until the next
// look-up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/playback/plausibility_bounds.hpp"

namespace hapticast::client {

/// How the surface of this tick was found.
enum class Lookup : std::uint8_t { kEmpty = 0, kInterpolated, kExtrapolated, kHeld, kStale };
inline constexpr std::size_t kLookupKinds = 5;

/// One object at play time. The relief moves with the object: sample `before` (and `after`) at the
/// point carried back into each frame and blend only what is left (surface_model.hpp).
struct InterpolatedObject {
  const PlayObject* before = nullptr;  ///< never null
  const PlayObject* after = nullptr;   ///< null when held, extrapolated or not in the next frame
  double blend = 0.0;               ///< 0 at `before` (or when a late `after` came), 1 at `after`
  double blend_rate_1_s = 0.0;      ///< d blend / dt; 0 when paused or without `after`
  bool appeared = false;            ///< was not in the scene of the last look-up (id and layer)
  Vec3 position_mm = Vec3::Zero();  ///< reference point at play time
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;
  double angular_velocity_rad_s = 0.0;
  PlausibilityBounds plausibility;  ///< of what its frames say beyond pose and relief
};

struct Scene {
  Lookup kind = Lookup::kEmpty;
  std::uint32_t epoch = 0;  ///< of the frame that is played
  bool jumped = false;      ///< epoch changed since the last look-up
  MediaTime play_time;
  std::array<InterpolatedObject, kMaxObjects> objects{};
  std::size_t object_count = 0;
};

}  // namespace hapticast::client
