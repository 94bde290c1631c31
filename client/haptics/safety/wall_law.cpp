// SPDX-License-Identifier: MIT
#include "client/haptics/safety/wall_law.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "client/haptics/hip_motion.hpp"
#include "common/tick.hpp"

namespace hapticast::client {

namespace {
constexpr double kBaseDamping_Ns_m = 1.0;  // B_0
constexpr double kStiffest_N_mm = 10.0;
constexpr double kMassShare = 0.64;
constexpr double kDampingShare = 0.2;
constexpr double kArmDepth_mm = 2.0;
}  // namespace

double wallLead_s(int delay_ticks) noexcept {
  // For 4 ticks: the mean of its neighbours (not measured).
  constexpr std::array<double, 6> kLead_s = {1.2e-3, 2.4e-3, 3.9e-3, 5.3e-3, 6.65e-3, 8.0e-3};
  return kLead_s[static_cast<std::size_t>(std::clamp(delay_ticks, 0, kMostDelay_ticks))];
}

double stiffnessLimit_N_mm(double mass_kg, int delay_ticks) noexcept {
  const double lead_s = wallLead_s(delay_ticks);
  return std::min(kStiffest_N_mm, kMassShare * mass_kg / (lead_s * lead_s) * 1e-3);
}

double stiffnessLimit_N_mm(const DeviceProfile& profile) noexcept {
  return stiffnessLimit_N_mm(profile.mass_kg, profile.delay_ticks);
}

double wallDamping_Ns_m(double stiffness_N_mm, double lead_s) noexcept {
  return stiffness_N_mm * 1e3 * lead_s + kBaseDamping_Ns_m;
}

double dampingLimit_Ns_m(double mass_kg, int delay_ticks) noexcept {
  const double delay_s = (0.5 + std::clamp(delay_ticks, 0, kMostDelay_ticks)) * kTick_s;
  return kDampingShare * mass_kg / delay_s;
}

double armDepth_mm(double stiffness_N_mm, double peak_N) noexcept {
  return stiffness_N_mm > 0.0 ? std::max(kArmDepth_mm, peak_N / stiffness_N_mm) : kArmDepth_mm;
}

}  // namespace hapticast::client
