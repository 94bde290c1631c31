// SPDX-License-Identifier: MIT
// What a wall may be made of on a given device: stiffness up to K_max, damping tied to stiffness
// and mass. Law and measurements: client/haptics/README.md. Real-time room.
#pragma once

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

inline constexpr int kMostDelay_ticks = 5;  ///< beyond it nothing is known

/// tau in s for a delay in ticks (0..5, beyond: 5): what a wall's K_max depends on.
double wallLead_s(int delay_ticks) noexcept;
/// K_max = min(10, 0.64 m / tau²) in N/mm: the stiffest that leaves at most 2 counts after an
/// impact (measured; 0.65 leaves 2.08 counts of 0.038 mm at a delay of one tick).
double stiffnessLimit_N_mm(double mass_kg, int delay_ticks) noexcept;
double stiffnessLimit_N_mm(const DeviceProfile& profile) noexcept;
/// Damping of the wall law in N·s/m for a local stiffness: B = sqrt(K m) at `limit_N_mm` (K_max),
/// half of it where the wall is soft against it: there the delay needs less, and what damps is felt
/// as an error of the force in motion.
double wallDamping_Ns_m(double stiffness_N_mm, double mass_kg, double limit_N_mm) noexcept;
/// What the law and an author's damping may come to together, N·s/m: a share of m / (T/2 + td),
/// where the damper's own delay makes it unstable. The law alone may be above it.
double dampingLimit_Ns_m(double mass_kg, int delay_ticks) noexcept;

/// What the damper may add at most, so that no first touch is a blow: the spring's own force and a
/// little more, and no more than grows with the ticks in contact.
class DamperLimit {
 public:
  /// A tick, in contact or not.
  void step(bool contact) noexcept;
  /// For a spring of `spring_N` along the normal.
  [[nodiscard]] double most_N(double spring_N) const noexcept;

 private:
  double grown_N_ = 0.0;
};

/// Deeper (device mm) than max(2 mm, peak/K) after a jump nothing arms until the hand has left.
double armDepth_mm(double stiffness_N_mm, double peak_N) noexcept;

}  // namespace hapticast::client
