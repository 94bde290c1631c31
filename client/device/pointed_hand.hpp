// SPDX-License-Identifier: MIT
// The virtual device in a light hand whose goal follows something that comes in steps, a pointer or
// a stick. Thread: the loop's.
#pragma once

#include "client/device/virtual/virtual_device.hpp"

namespace hapticast::client {

class PointedHand {
 public:
  /// `clock` outlives it.
  PointedHand(const PlantProfile& profile, const Clock& clock)
      : device_(profile, Hand::light(), clock) {}

  [[nodiscard]] const DeviceProfile& profile() const noexcept { return device_.profile(); }
  void waitForTick(LocalTime deadline) noexcept { device_.waitForTick(deadline); }
  DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept {
    return device_.exchange(force_N, report);
  }
  [[nodiscard]] Vec3 tip_mm() const noexcept { return device_.truePosition_mm(); }

  /// One tick on the way to this place (device frame, finite). Before the first call the hand
  /// rests.
  void moveTowards(const Vec3& wanted_mm) noexcept;

 private:
  VirtualDevice device_;
  bool moves_ = false;
  Vec3 goal_mm_ = Vec3::Zero();
  Vec3 velocity_mm_s_ = Vec3::Zero();
};

}  // namespace hapticast::client
