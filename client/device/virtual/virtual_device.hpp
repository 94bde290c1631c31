// SPDX-License-Identifier: MIT
// Simulated haptic device with the mass, losses, encoder counts and delay of a profile. A simulated
// hand (mass, spring and damper) moves it, with or without a script.
// Thread: loop.
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
  static constexpr int kLongestDelay_ticks = 6;  ///< longest delay of a profile, plus one tick

  /// Creates a device that is 30 mm above the middle. The hand rests there until lead() or
  /// setTarget(). If profile.count_mm is at most 0, positions are not rounded to counts.
  /// profile.delay_ticks is clamped to 0..6. `clock` must outlive this object.
  VirtualDevice(const PlantProfile& profile, const Hand& hand, const Clock& clock) noexcept;
  /// Makes `script` generate the target of the hand. At each exchange() the script reads the report
  /// of the tick before. `name` is the script's name for description(). Call it before the loop.
  void lead(HandScript script, std::string name);

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  [[nodiscard]] std::string description() const override;
  /// Sleeps until `deadline` on CLOCK_MONOTONIC. Do not call it with a clock that tests set by
  /// hand, because that clock does not advance during the sleep.
  void waitForTick(LocalTime deadline) noexcept override;
  /// Simulates all ticks since the last call (1 to 1000), and returns the position at their end.
  /// The profile's delay_ticks is the delay from that position to the begin of its force.
  DeviceState exchange(const Vec3& force_N, const TickReport& report) noexcept override;

  // For tests and hapticast-evaluate, which control the device under a clock that they set by hand.
  void reset(const Vec3& position_mm, const Vec3& velocity_mm_s) noexcept;
  void setTarget(const Vec3& target_mm) noexcept { target_mm_ = target_mm; }  ///< device frame
  /// Sets a constant force of the hand in addition to its spring.
  void setPush(const Vec3& push_N) noexcept { push_N_ = push_N; }
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
  std::array<Vec3, kLongestDelay_ticks + 1> sent_N_;  // ring buffer
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
