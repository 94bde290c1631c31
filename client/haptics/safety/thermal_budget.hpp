// SPDX-License-Identifier: MIT
// Thermal budget of the motors. A one-pole model estimates their heat from the square of the force.
// The heat determines the largest force.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/haptic_device.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Estimates the heat of the motors. Computes the largest force that they allow.
class ThermalBudget {
 public:
  explicit ThermalBudget(const DeviceProfile& profile) noexcept
      : peak_N_(profile.peak_N),
        lasting_N_(kLasting * profile.continuous_N),
        square_N2_(profile.continuous_N * profile.continuous_N),
        share_(kTick_s / profile.thermal_s) {}

  /// Adds one tick to the heat. `force_N2` is the squared magnitude of its force, N².
  void add(double force_N2) noexcept { heat_N2_ += (force_N2 - heat_N2_) * share_; }
  /// Returns the largest force for this tick, N. It is the device's peak while the heat is below
  /// 0.6 of the square of the continuous force. Above that, the limit falls linearly with the heat.
  /// It reaches 0.98 of the continuous force when the heat equals the square of that force.
  [[nodiscard]] double limit_N() const noexcept {
    if (heat_N2_ <= kCool * square_N2_) return peak_N_;
    if (heat_N2_ >= square_N2_) return lasting_N_;
    return peak_N_ + (lasting_N_ - peak_N_) * (heat_N2_ / square_N2_ - kCool) / (1.0 - kCool);
  }

 private:
  static constexpr double kCool = 0.6;      // the value is a choice
  static constexpr double kLasting = 0.98;  // a choice: slightly below the continuous force
  double peak_N_, lasting_N_, square_N2_, share_;
  double heat_N2_ = 0.0;  // mean square of the force over the last thermal_s
};

}  // namespace hapticast::client
