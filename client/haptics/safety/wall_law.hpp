// SPDX-License-Identifier: MIT
// Wall law: the stiffness and the damping that a device renders without instability. Stiffness is
// at most K_max. Damping follows stiffness and mass. client/haptics/README.md, sections 5 and 6,
// has the law and its measurements.
// Thread: any (pure functions); DamperLimit: loop.
#pragma once

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

inline constexpr int kMostDelay_ticks = 5;  ///< longest delay with measurements

/// Returns tau (s) for a delay in ticks, clamped to 0..5. K_max depends on tau.
double wallLead_s(int delay_ticks) noexcept;
/// Returns K_max = min(10, 0.64 m / tau²) in N/mm: the stiffest wall that leaves at most 2 counts
/// after an impact. Measured: 0.65 instead of 0.64 leaves 2.08 counts of 0.038 mm at a delay of one
/// tick.
double stiffnessLimit_N_mm(double mass_kg, int delay_ticks) noexcept;
double stiffnessLimit_N_mm(const DeviceProfile& profile) noexcept;
/// Returns the damping of the wall law (N·s/m) for a local stiffness: B = sqrt(K m) at `limit_N_mm`
/// (K_max). B falls to half of that for a soft wall, where the delay needs less damping and damping
/// adds an error of the force in motion.
double wallDamping_Ns_m(double stiffness_N_mm, double mass_kg, double limit_N_mm) noexcept;
/// Returns the limit (N·s/m) for the sum of the law's damping and an author's damping. The limit is
/// a share of m / (T/2 + d T), where the damper's own delay makes it unstable. The law alone may
/// exceed it.
double dampingLimit_Ns_m(double mass_kg, int delay_ticks) noexcept;

/// Limit of the damper's force, so that no first touch is a blow. It is 0.04 N plus the spring's
/// force. A bound that grows with the ticks in contact replaces a larger spring force.
class DamperLimit {
 public:
  /// Advances the bound by one tick.
  void step(bool contact) noexcept;
  /// Returns the limit (N) for a spring force of `spring_N` along the normal.
  [[nodiscard]] double most_N(double spring_N) const noexcept;

 private:
  double grown_N_ = 0.0;
};

/// Arming depth, device mm: max(2 mm, peak/K). A HIP deeper than that after a jump stays disarmed
/// until it is out.
double armDepth_mm(double stiffness_N_mm, double peak_N) noexcept;

}  // namespace hapticast::client
