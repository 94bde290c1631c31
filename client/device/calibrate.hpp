// SPDX-License-Identifier: MIT
// Calibration of a Falcon's motors (check --calibrate) with a known weight. A position controller
// moves the grip to the middle and holds it there, first without the weight and then with it. With
// the right gain, the force of the controller increases by exactly the weight. So the corrected
// gain is the present gain, multiplied by the ratio of the measured increase to the weight. Thread:
// one, which runs the ticks of the device.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// PID controller that moves the grip to the middle of the workspace and holds it there against
/// outside forces. It uses no device and no clock. Call hold() once a tick.
class GripHolder {
 public:
  /// Returns the force (N) that moves the grip from `position_mm` to the middle.
  Vec3 hold(const Vec3& position_mm) noexcept;
  /// Returns the mean force since the grip came to rest in the middle. Returns nullopt until it has
  /// rested there for two seconds.
  [[nodiscard]] std::optional<Vec3> restForce_N() const noexcept;
  /// Starts a new measurement of two seconds.
  void begin() noexcept { rest_ticks_ = 0; }

 private:
  bool started_ = false;
  Vec3 last_mm_ = Vec3::Zero();
  Vec3 velocity_mm_s_ = Vec3::Zero();
  Vec3 integral_N_ = Vec3::Zero();
  Vec3 sum_N_ = Vec3::Zero();
  int rest_ticks_ = 0;
};

/// Guides the user through the calibration. `log_line` receives the instructions. `gain` is the
/// present gain in counts/(N m), and `weight_g` is the weight in g. Returns the corrected gain.
/// Returns nullopt if `stop` becomes true meanwhile. Throws std::runtime_error (one line) if the
/// calibration fails.
std::optional<double> calibrate(HapticDevice& device, const Clock& clock, double gain,
                                double weight_g, const std::atomic<bool>& stop,
                                const std::function<void(const std::string& line)>& log_line);

/// Writes the line `falcon-gain = gain` into the config file `file`. It replaces the first such
/// line, or appends a line if there is none. Throws std::runtime_error (one line).
void storeGain(const std::string& file, double gain);

}  // namespace hapticast::client
