// SPDX-License-Identifier: MIT
#include "client/haptics/safety/wall_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
constexpr double kFirstTouch_N = 0.04;   // chosen
constexpr double kGrowth_N = 0.04;       // per tick; chosen: a fifth of the slew limit
constexpr double kShrink_N = 0.5;        // per tick without contact; chosen
constexpr double kGrown_N = 20.0;        // above any device's peak
constexpr double kStiffest_N_mm = 10.0;  // measured: above, chatter of one count at 1 kHz
constexpr double kMassShare = 0.64;      // measured
constexpr double kDampingShare = 0.35;   // measured: more buzzes in motion, counts move the speed
constexpr double kArmDepth_mm = 2.0;     // chosen
}  // namespace

double wallLead_s(int delay_ticks) noexcept {
  // Measured with battery and presses of client/haptics/stability.md. The value for 4 ticks
  // is the mean of its neighbours and was not measured.
  constexpr std::array<double, 6> kLead_s = {1.2e-3, 2.19e-3, 3.09e-3, 3.79e-3, 6.14e-3, 8.48e-3};
  return kLead_s[static_cast<std::size_t>(std::clamp(delay_ticks, 0, kMostDelay_ticks))];
}

double stiffnessLimit_N_mm(double mass_kg, int delay_ticks) noexcept {
  const double lead_s = wallLead_s(delay_ticks);
  return std::min(kStiffest_N_mm, kMassShare * mass_kg / (lead_s * lead_s) * 1e-3);
}

double stiffnessLimit_N_mm(const DeviceProfile& profile) noexcept {
  return stiffnessLimit_N_mm(profile.mass_kg, profile.delay_ticks);
}

double wallDamping_Ns_m(double stiffness_N_mm, double mass_kg, double limit_N_mm) noexcept {
  const double share = 0.5 + 0.5 * std::min(1.0, stiffness_N_mm / limit_N_mm);
  return share * std::sqrt(stiffness_N_mm * 1e3 * mass_kg);
}

void DamperLimit::step(bool contact) noexcept {
  grown_N_ = std::clamp(grown_N_ + (contact ? kGrowth_N : -kShrink_N), 0.0, kGrown_N);
}

double DamperLimit::most_N(double spring_N) const noexcept {
  return kFirstTouch_N + std::min(spring_N, grown_N_);
}

double dampingLimit_Ns_m(double mass_kg, int delay_ticks) noexcept {
  const double delay_s = (1.5 + std::clamp(delay_ticks, 0, kMostDelay_ticks)) * kTick_s;
  return kDampingShare * mass_kg / delay_s;
}

double armDepth_mm(double stiffness_N_mm, double peak_N) noexcept {
  return stiffness_N_mm > 0.0 ? std::max(kArmDepth_mm, peak_N / stiffness_N_mm) : kArmDepth_mm;
}

}  // namespace hapticast::client
