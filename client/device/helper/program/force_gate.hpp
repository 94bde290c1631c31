// SPDX-License-Identifier: MIT
// Watchdog of the helper process: passes the client's force to the driver while the client sends
// commands. If the newest command is older than 10 ms, the force descends to zero within another 10
// ms. When commands arrive again, the force rises to its full value in half a second.
// Thread: loop of the helper.
#pragma once

#include "client/device/helper/shared_page.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

class ForceGate {
 public:
  /// Returns the force for the driver at the time `now`. `command` is the client's newest command.
  /// `alive` is false if the force has to end: the force then descends to zero.
  Vec3 computeForce_N(const DeviceCommand& command, bool alive, LocalTime now) noexcept;
  /// Sets the force to zero. The force then rises as after missing commands. Call it after another
  /// thread has commanded zero to the driver.
  void close() noexcept { share_ = 0.0; }
  /// Returns true if the last result was smaller than the commanded force.
  [[nodiscard]] bool reduces() const noexcept { return reduces_; }
  /// Returns true if the last result was zero.
  [[nodiscard]] bool atZero() const noexcept { return at_zero_; }

 private:
  double share_ = 1.0;
  bool at_zero_ = true;
  bool reduces_ = false;
  LocalTime last_{};
};

}  // namespace hapticast::client
