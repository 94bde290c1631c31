// SPDX-License-Identifier: MIT
// The arms of a Falcon, from the closure of each leg and by numbers: bisection for the angle,
// finite differences for the force. Shares no code with the client's kinematics, so that a wrong
// sign there shows.
#pragma once

#include "common/geometry.hpp"

namespace hapticast::testing {

/// Encoder counts with the grip at `position_m`, without rounding.
Vec3 encodersAt(const Vec3& position_m);
/// Force at the grip in N when the motors get these counts, for a gain in counts/(N m).
Vec3 forceAt_N(const Vec3& position_m, const Vec3& motors, double gain);

}  // namespace hapticast::testing
