// SPDX-License-Identifier: MIT
// The loop's period, said once: 1 kHz is what haptic rendering of stiff surfaces asks for.
#pragma once

#include "common/time.hpp"

namespace hapticast {

inline constexpr Duration kTickPeriod{1'000'000};
inline constexpr double kTick_s = 1e-3;  ///< the same in seconds
static_assert(fromSeconds(kTick_s) == kTickPeriod);

}  // namespace hapticast
