// SPDX-License-Identifier: MIT
// What a device's motors can stand for good: a model of their heat, and the force it leaves
// (stability notes, section 5.6). Real-time room.
#pragma once

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/hip_motion.hpp"

namespace hapticast::client {

class ThermalBudget {
 public:
  explicit ThermalBudget(const DeviceProfile& profile) noexcept
      : peak_N_(profile.peak_N),
        continuous_N_(profile.continuous_N),
        share_(kTick_s / profile.thermal_s) {}

  /// A tick of `force_N` (its size).
  void add(double force_N) noexcept { heat_N2_ += (force_N * force_N - heat_N2_) * share_; }
  /// The peak while heat < 0.6 cont², then linear down to 0.98 cont at cont² and beyond.
  [[nodiscard]] double limit_N() const noexcept {
    const double heat = heat_N2_ / (continuous_N_ * continuous_N_);
    if (heat <= kCool) return peak_N_;
    const double lasting_N = kLasting * continuous_N_;
    return heat >= 1.0 ? lasting_N
                       : peak_N_ + (lasting_N - peak_N_) * (heat - kCool) / (1.0 - kCool);
  }

 private:
  static constexpr double kCool = 0.6;
  static constexpr double kLasting = 0.98;
  double peak_N_, continuous_N_, share_;
  double heat_N2_ = 0.0;  // the mean square of the force over the last thermal_s
};

}  // namespace hapticast::client
