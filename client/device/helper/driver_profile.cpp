// SPDX-License-Identifier: MIT
#include "client/device/helper/driver_profile.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "client/device/device_request.hpp"
#include "client/haptics/safety/wall_law.hpp"

namespace hapticast::client {

namespace {

// Assumed for an unknown value: lighter, coarser and slower than the built-in profiles.
constexpr double kUnknownMass_kg = 0.03;
constexpr double kUnknownCount_mm = 0.1;
constexpr int kUnknownDelay_ticks = 2;
constexpr double kUnknownWorkspace_mm = 100.0;

/// Returns `value` within the range, or `otherwise` if it is unknown or no number.
double limit(double value, double least, double most, double otherwise) {
  return std::isfinite(value) && value > 0.0 ? std::clamp(value, least, most) : otherwise;
}

std::optional<int> toButton(std::int32_t bit) {
  return bit >= 0 && bit < 32 ? std::optional<int>(bit) : std::nullopt;
}

/// The forces of the chain are the Omni's, scaled by the peak.
void scaleForces(PlantProfile& profile, double peak_N) {
  const double scale = peak_N / profile.peak_N;
  profile.peak_N = peak_N;
  for (double PlantProfile::*const each :
       {&PlantProfile::slew_rise_N_per_tick, &PlantProfile::slew_fall_N_per_tick,
        &PlantProfile::residue_N_per_tick, &PlantProfile::pulse_limit_N, &PlantProfile::tank_mJ,
        &PlantProfile::tank_W, &PlantProfile::continuous_N})
    profile.*each *= scale;
}

PlantProfile convertDriver(const std::string& name, const hapticast_profile& driver) {
  PlantProfile profile = loadDeviceProfile("omni");
  profile.name = name;
  double peak_N = limit(driver.peak_N, 0.1, 20.0, profile.peak_N);
  if (driver.watchdog_ms <= 0) peak_N = std::min(peak_N, kPeakWithoutWatchdog_N);
  scaleForces(profile, peak_N);
  profile.continuous_N =
      std::min(limit(driver.continuous_N, 0.01, 20.0, profile.continuous_N), peak_N);
  profile.mass_kg = limit(driver.mass_kg, 0.005, 1.0, kUnknownMass_kg);
  profile.count_mm = limit(driver.count_mm, 0.001, 1.0, kUnknownCount_mm);
  profile.stiffness_N_mm = limit(driver.stiffness_N_mm, 0.01, 5.0, profile.stiffness_N_mm);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    profile.workspace_mm[axis] =
        limit(driver.workspace_mm[axis], 10.0, 1000.0, kUnknownWorkspace_mm);
  return profile;
}

}  // namespace

hapticast_profile unknownProfile() noexcept {
  hapticast_profile profile{};
  profile.size = sizeof profile;
  profile.delay_ticks = -1;
  profile.enable_button = profile.pause_button = profile.rearm_button = -1;
  return profile;
}

PlantProfile convertProfile(const std::string& name, const hapticast_profile& driver,
                            const std::string& users) {
  const int delay_ticks = driver.delay_ticks < 0
                              ? kUnknownDelay_ticks
                              : std::min<int>(driver.delay_ticks, kMostDelay_ticks);
  PlantProfile profile = users.empty() ? convertDriver(name, driver) : loadProfile(users);
  profile.delay_ticks = users.empty() ? delay_ticks : std::max(profile.delay_ticks, delay_ticks);
  if (!profile.enable_button) profile.enable_button = toButton(driver.enable_button);
  profile.pause_button = toButton(driver.pause_button);
  profile.rearm_button = toButton(driver.rearm_button);
  return profile;
}

}  // namespace hapticast::client
