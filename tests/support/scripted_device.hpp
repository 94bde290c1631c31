// SPDX-License-Identifier: MIT
// The smallest device that a test needs: what it waits for and what it answers are functions of the
// test. Also the proof that a further device costs one file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

class ScriptedDevice final : public HapticDevice {
 public:
  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return its_profile; }
  [[nodiscard]] std::string description() const override { return "scripted device"; }
  void waitForTick(LocalTime deadline) noexcept override {
    deadlines.push_back(deadline);
    if (wait) wait(deadline);
  }
  DeviceState exchange(const Vec3& force_N, const TickReport& /*report*/) noexcept override {
    forces_N.push_back(force_N);
    return answer ? answer(force_N) : DeviceState{};
  }

  DeviceProfile its_profile;
  std::function<void(LocalTime deadline)> wait;
  std::function<DeviceState(const Vec3& force_N)> answer;
  // What the loop asked for; read it when the loop has ended.
  std::vector<LocalTime> deadlines;
  std::vector<Vec3> forces_N;
};

}  // namespace hapticast::client
