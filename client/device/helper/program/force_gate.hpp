// SPDX-License-Identifier: MIT
// Watchdog of the helper process: passes the client's force on while the client is alive. When the
// commands stop, the force descends to zero within 10 ms. When they come back, it returns over half
// a second.
// Thread: loop of the helper.
#pragma once

#include "client/device/helper/shared_page.hpp"
#include "common/geometry.hpp"
#include "common/time.hpp"

namespace hapticast::client {

class ForceGate {
 public:
  /// Returns the force for the driver at `now`. `command` is the newest one. `alive` is false if
  /// the client has ended.
  Vec3 computeForce_N(const DeviceCommand& command, bool alive, LocalTime now) noexcept;
  /// Sets the force to zero; it then returns like after a silence. Call it after the driver has
  /// received zero from another thread.
  void close() noexcept { share_ = 0.0; }
  /// Returns true if the last force was smaller than the commanded one.
  [[nodiscard]] bool reduces() const noexcept { return reduces_; }
  /// Returns true if the last force was zero.
  [[nodiscard]] bool atZero() const noexcept { return at_zero_; }

 private:
  double share_ = 1.0;
  bool at_zero_ = true;
  bool reduces_ = false;
  LocalTime last_{};
};

}  // namespace hapticast::client
