// SPDX-License-Identifier: MIT
// What a device's motors can stand for good: a model of their heat, and the force it leaves
// (stability notes, section 5.6). Real-time room.
#pragma once

#include "client/haptics/haptic_device.hpp"
#include "client/haptics/hip_motion.hpp"
#include "common/tick.hpp"

namespace hapticast::client {

class ThermalBudget {
 public:
  explicit ThermalBudget(const DeviceProfile& profile) noexcept
      : peak_N_(profile.peak_N),
        lasting_N_(kLasting * profile.continuous_N),
        square_N2_(profile.continuous_N * profile.continuous_N),
        share_(kTick_s / profile.thermal_s) {}

  /// A tick of a force whose square is `force_N2`.
  void add(double force_N2) noexcept { heat_N2_ += (force_N2 - heat_N2_) * share_; }
  /// The peak while heat < 0.6 cont², then linear down to 0.98 cont at cont² and beyond.
  [[nodiscard]] double limit_N() const noexcept {
    if (heat_N2_ <= kCool * square_N2_) return peak_N_;
    if (heat_N2_ >= square_N2_) return lasting_N_;
    return peak_N_ + (lasting_N_ - peak_N_) * (heat_N2_ / square_N2_ - kCool) / (1.0 - kCool);
  }

 private:
  static constexpr double kCool = 0.6;
  static constexpr double kLasting = 0.98;
  double peak_N_, lasting_N_, square_N2_, share_;
  double heat_N2_ = 0.0;  // the mean square of the force over the last thermal_s
};

}  // namespace hapticast::client
