// SPDX-License-Identifier: MIT
// A haptic device made of arithmetic: mass, losses, counts and delay of a profile, in a hand that
// is a mass-spring-damper and may be led by a script. Thread: the loop's.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "client/device/virtual/axis_plant.hpp"
#include "client/device/virtual/hand_script.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

class VirtualDevice final : public HapticDevice {
 public:
  static constexpr int kLongestDelay_ticks = 5;

  /// `clock` outlives the device. count_mm <= 0 in the profile: not quantised. delay_ticks is
  /// clamped to 0..5. Starts 30 mm above the middle. The hand rests there until it is led.
  VirtualDevice(const PlantProfile& profile, const Hand& hand, const Clock& clock) noexcept;
  /// Lets `script` set the target of the hand. The script reads the report of each exchange().
  /// `name`: for the description. Call before the loop.
  void lead(HandScript script, std::string name);

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] std::string description() const override;
  /// Absolute sleep on CLOCK_MONOTONIC. A virtual clock is advanced by hand and never waited for:
  /// whoever drives one does not call this.
  void waitForTick(LocalTime deadline) noexcept override;
  /// Lives through the ticks since the last call (one at least; a second at most), then says where
  /// it is. The force acts delay_ticks after the last position was said.
  DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept override;

  // For whoever drives the device by hand under a virtual clock: tests and evaluate.
  void reset(const Vec3& position_mm, const Vec3& velocity_mm_s) noexcept;
  void setTarget(const Vec3& target_mm) noexcept { target_mm_ = target_mm; }  ///< device frame
  void setPush(const Vec3& push_N) noexcept { push_N_ = push_N; }  ///< constant force of the hand
  [[nodiscard]] Vec3 truePosition_mm() const noexcept;
  [[nodiscard]] Vec3 trueVelocity_mm_s() const noexcept;

 private:
  void advanceScript(const TickReport& report) noexcept;
  int ticksSinceLast() noexcept;
  void advance(const Vec3& force_N, const Vec3& target_from_mm,
               const Vec3& target_velocity_mm_s) noexcept;

  PlantProfile profile_;
  const Clock& clock_;
  std::array<AxisPlant, 3> axes_;
  std::array<Vec3, kLongestDelay_ticks + 1> sent_N_;  // ring
  std::size_t delay_;
  std::size_t newest_ = 0;
  bool running_ = false;
  LocalTime time_{};
  Vec3 target_mm_ = Vec3::Zero();
  Vec3 last_target_mm_ = Vec3::Zero();
  Vec3 push_N_ = Vec3::Zero();
  std::optional<HandScript> script_;
  std::uint64_t seen_tick_ = 0;
  std::string led_by_;
};

}  // namespace hapticast::client
