// SPDX-License-Identifier: MIT
// Gamepad as a device. Its sticks move a simulated hand, and its two motors rumble with the force.
// Thread: any (pure functions).
#pragma once

#include <cstdint>

#include "client/haptics/force_components.hpp"
#include "common/geometry.hpp"

namespace hapticast::client {

/// Returns the velocity (nominal mm/s) that the sticks command for the simulated hand. `left` and
/// `right` are the positions of the two sticks, each component within -1..1, positive to the right
/// and down. The left stick moves the hand over the picture. The right stick moves it into the
/// picture (stick forward) and out of it (stick back).
[[nodiscard]] Vec3 stickVelocity_mm_s(const Vec2& left, const Vec2& right) noexcept;

/// Returns the level of a rumble motor for a force of `force_N`, 0..65535 (SDL's range).
[[nodiscard]] std::uint16_t motorLevel(double force_N) noexcept;

}  // namespace hapticast::client
