// SPDX-License-Identifier: MIT
// A simulated device in a simulated light hand. A pointer or a stick moves the hand. The position
// of such an input changes in steps, so the target of the hand follows the input with critical
// damping.
// Thread: loop.
#pragma once

#include "client/device/virtual/virtual_device.hpp"

namespace hapticast::client {

/// Smooths the input, and simulates the device in the hand.
class PointedHand {
 public:
  /// `clock` must outlive this object.
  PointedHand(const PlantProfile& profile, const Clock& clock)
      : device_(profile, Hand::light(), clock) {}

  [[nodiscard]] const DeviceProfile& profile() const noexcept { return device_.profile(); }
  void waitForTick(LocalTime deadline) noexcept { device_.waitForTick(deadline); }
  DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept {
    return device_.exchange(force_N, report);
  }
  /// Returns the simulated position of the HIP in the device frame, before it is rounded to counts.
  [[nodiscard]] Vec3 tip_mm() const noexcept { return device_.truePosition_mm(); }

  /// Moves the target of the hand for one tick towards `wanted_mm` (device frame, finite). Before
  /// the first call the hand rests.
  void moveTowards(const Vec3& wanted_mm) noexcept;

 private:
  VirtualDevice device_;
  bool moves_ = false;
  Vec3 goal_mm_ = Vec3::Zero();
  Vec3 velocity_mm_s_ = Vec3::Zero();
};

}  // namespace hapticast::client
