// SPDX-License-Identifier: MIT
// Wall law: the stiffness and the damping of a wall that a device renders without instability. The
// stiffness is at most K_max, which depends on the device's mass and delay. The damping follows
// from stiffness and mass. client/haptics/safety/README.md has the law,
// client/haptics/stability.md its measurements.
// Thread: any (pure functions); DamperLimit: loop.
#pragma once

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Returns the time constant tau (s) of the wall law for a delay in ticks, clamped to 0..5. K_max
/// depends on tau.
double wallLead_s(int delay_ticks) noexcept;
/// Returns K_max = min(10, 0.64 m / tau²) in N/mm. K_max is the stiffest wall at which the HIP
/// swings by at most 2 counts after an impact. The factor and tau were measured together
/// (client/haptics/stability.md).
double stiffnessLimit_N_mm(double mass_kg, int delay_ticks) noexcept;
double stiffnessLimit_N_mm(const DeviceProfile& profile) noexcept;
/// Returns the damping of the wall law (N·s/m) for the stiffness K = `stiffness_N_mm` along the
/// normal and the mass m. `limit_N_mm` is K_max. At K_max the damping is sqrt(K m). For a softer
/// wall it falls to half of sqrt(K m), because the delay then needs less damping. Damping also adds
/// an error of the force in motion.
double wallDamping_Ns_m(double stiffness_N_mm, double mass_kg, double limit_N_mm) noexcept;
/// Returns the largest sum (N·s/m) of the law's damping and an author's damping. The result is 0.35
/// m / (T/2 + (d + 1) T), with the mass m, the tick T and the delay d in ticks. The estimate of the
/// velocity adds one tick of delay. A damper of the full m / (T/2 + d T) would be unstable because
/// of its own delay. The law's damping alone may exceed the result.
double dampingLimit_Ns_m(double mass_kg, int delay_ticks) noexcept;

/// Limit of the damper's force. It prevents a blow at the begin of a contact. The limit is 0.04 N
/// plus the smaller of two forces: the spring's force, and a bound that grows with every tick in
/// contact.
class DamperLimit {
 public:
  /// Advances the growing bound by one tick. If `contact` is true, the bound grows, else it
  /// shrinks.
  void step(bool contact) noexcept;
  /// Returns the largest force of the damper (N) when the spring's force along the normal is
  /// `spring_N`.
  [[nodiscard]] double most_N(double spring_N) const noexcept;

 private:
  double grown_N_ = 0.0;
};

/// Returns the arming depth: max(2 mm, peak / stiffness), device mm. If the HIP is deeper than that
/// after a jump, there is no force until the HIP is out of the surface.
double armDepth_mm(double stiffness_N_mm, double peak_N) noexcept;

}  // namespace hapticast::client
