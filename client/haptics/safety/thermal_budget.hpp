// SPDX-License-Identifier: MIT
// Thermal budget of the motors: a one-pole heat model driven by the square of the force, and the
// force limit that follows from the heat.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/haptic_device.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Heat model and force limit.
class ThermalBudget {
 public:
  explicit ThermalBudget(const DeviceProfile& profile) noexcept
      : peak_N_(profile.peak_N),
        lasting_N_(kLasting * profile.continuous_N),
        square_N2_(profile.continuous_N * profile.continuous_N),
        share_(kTick_s / profile.thermal_s) {}

  /// Adds a tick with the squared force `force_N2`, N².
  void add(double force_N2) noexcept { heat_N2_ += (force_N2 - heat_N2_) * share_; }
  /// Force limit, N: the peak while the heat is below 0.6 cont². Above, it falls linearly to 0.98
  /// cont at cont².
  [[nodiscard]] double limit_N() const noexcept {
    if (heat_N2_ <= kCool * square_N2_) return peak_N_;
    if (heat_N2_ >= square_N2_) return lasting_N_;
    return peak_N_ + (lasting_N_ - peak_N_) * (heat_N2_ / square_N2_ - kCool) / (1.0 - kCool);
  }

 private:
  static constexpr double kCool = 0.6;      // chosen
  static constexpr double kLasting = 0.98;  // chosen: slightly below the continuous force
  double peak_N_, lasting_N_, square_N2_, share_;
  double heat_N2_ = 0.0;  // mean square of the force over the last thermal_s
};

}  // namespace hapticast::client
