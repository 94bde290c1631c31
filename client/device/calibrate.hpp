// SPDX-License-Identifier: MIT
// --falcon-calibrate: what the motors have to be sent for a newton, found with a known weight. The
// device holds its grip in the middle by itself; the force that it needs more under the weight is
// the weight's. Thread: one, which turns the device.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Holds a grip in the middle. Pure. One step a tick.
class GripHolder {
 public:
  /// The force for where it is now.
  Vec3 hold(const Vec3& position_mm) noexcept;
  /// Mean force of the last two seconds, when the grip has been at rest in the middle as long.
  [[nodiscard]] std::optional<Vec3> restForce_N() const noexcept;
  /// The two seconds begin now.
  void begin() noexcept { rest_ticks_ = 0; }

 private:
  bool started_ = false;
  Vec3 last_mm_ = Vec3::Zero();
  Vec3 velocity_mm_s_ = Vec3::Zero();
  Vec3 integral_N_ = Vec3::Zero();
  Vec3 sum_N_ = Vec3::Zero();
  int rest_ticks_ = 0;
};

/// Leads the user through it by `log_line`, and returns the gain where `gain` has been used; none:
/// it was stopped. Throws std::runtime_error, one line, where it does not work.
std::optional<double> calibrate(HapticDevice& device, const Clock& clock, double gain,
                                double weight_g, const std::atomic<bool>& stop,
                                const std::function<void(const std::string& line)>& log_line);

/// Puts `falcon-gain = gain` into a config file, in place of such a line or at its end. Throws
/// std::runtime_error, one line.
void storeGain(const std::string& file, double gain);

}  // namespace hapticast::client
