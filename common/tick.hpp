// SPDX-License-Identifier: MIT
// Period of the haptic loop: 1 kHz, the usual rate for the haptic rendering of stiff surfaces.
// Thread: any.
#pragma once

#include "common/time.hpp"

namespace hapticast {

inline constexpr Duration kTickPeriod{1'000'000};
inline constexpr double kTick_s = 1e-3;  ///< kTickPeriod in seconds
static_assert(fromSeconds(kTick_s) == kTickPeriod);

}  // namespace hapticast
