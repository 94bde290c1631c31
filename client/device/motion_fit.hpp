// SPDX-License-Identifier: MIT
// Fit of a free device's motion (system identification by least squares). The device is a mass with
// damping, Coulomb friction and a constant force such as its weight:
//   m x'' = F(t - d) - c x' - f sign(x') + g
// Integrated twice, the equation is linear in 1/m, c/m, f/m, g/m and the initial state. The fit
// solves it for each delay d, and selects the delay with the smallest residual.
// Thread: any.
#pragma once

#include <span>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Longest delay that fitMotion() tries, ticks.
inline constexpr int kMostFittedDelay_ticks = 8;

/// Result of a fit.
struct MotionFit {
  /// Moving mass; not above 0 if the motion does not follow the force, or opposes it.
  double mass_kg = 0.0;
  int delay_ticks = 0;       ///< ticks from the reading of a position to the begin of its force
  double residual_mm = 0.0;  ///< root mean square of the difference between motion and fit
};

/// Fits the motion along one axis. Sample k of `position_mm` is the reading of tick k, and sample k
/// of `force_N` is the force sent for it, at one tick a millisecond. Requires two spans of the same
/// size, at least 20 samples.
MotionFit fitMotion(std::span<const double> force_N, std::span<const double> position_mm);

}  // namespace hapticast::client
