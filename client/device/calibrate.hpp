// SPDX-License-Identifier: MIT
// Calibration of a Falcon's motors (--falcon-calibrate) with a known weight. A position controller
// holds the grip in the middle. The additional force under the weight equals the weight, so the
// ratio of both corrects the gain.
// Thread: one, which runs the ticks of the device.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// PID controller that holds the grip in the middle. Pure; call once a tick.
class GripHolder {
 public:
  /// Returns the force (N) for the grip at `position_mm`.
  Vec3 hold(const Vec3& position_mm) noexcept;
  /// Returns the mean force of the last two seconds; nullopt unless the grip was at rest in the
  /// middle for that time.
  [[nodiscard]] std::optional<Vec3> restForce_N() const noexcept;
  /// Restarts the two seconds.
  void begin() noexcept { rest_ticks_ = 0; }

 private:
  bool started_ = false;
  Vec3 last_mm_ = Vec3::Zero();
  Vec3 velocity_mm_s_ = Vec3::Zero();
  Vec3 integral_N_ = Vec3::Zero();
  Vec3 sum_N_ = Vec3::Zero();
  int rest_ticks_ = 0;
};

/// Guides the user through the calibration with lines to `tell`. `gain` is the present gain,
/// `weight_g` the weight. Returns the corrected gain; nullopt after `stop`. Throws
/// std::runtime_error (one line) if the calibration fails.
std::optional<double> calibrate(HapticDevice& device, const Clock& clock, double gain,
                                double weight_g, const std::atomic<bool>& stop,
                                const std::function<void(const std::string& line)>& log_line);

/// Writes `falcon-gain = gain` into the config file `file`: replaces the first such line, or
/// appends one. Throws std::runtime_error (one line).
void storeGain(const std::string& file, double gain);

}  // namespace hapticast::client
