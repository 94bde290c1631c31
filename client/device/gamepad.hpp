// SPDX-License-Identifier: MIT
// A gamepad as a device: its sticks lead a hand, its two motors rumble with the force.
#pragma once

#include <cstdint>

#include "client/haptics/force_components.hpp"
#include "common/geometry.hpp"

namespace hapticast::client {

/// How fast the sticks lead the hand, nominal mm/s. Each stick within -1..1, right and down
/// positive: the left one goes over the picture, the right one forward into it and back out of it.
[[nodiscard]] Vec3 stickVelocity_mm_s(const Vec2& left, const Vec2& right) noexcept;

/// How strongly a motor turns for this force, in the 65535 steps that SDL has.
[[nodiscard]] std::uint16_t motorLevel(double force_N) noexcept;

}  // namespace hapticast::client
