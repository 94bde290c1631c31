// SPDX-License-Identifier: MIT
// A haptic device made of arithmetic: mass, damping, Coulomb friction, counts and delay of a
// profile, in a hand that is a mass-spring-damper. Solved exactly over each tick, because a cheaper
// integrator hides the very instability it is there to show. Thread: the loop's.
#pragma once

#include <array>

#include "client/device/hand_script.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// A hand, the same on every axis. It holds the device rigidly (grip_N_m = 0: the masses add) or
/// behind the spring and damper of a grip; its own spring and damper pull it to the target. All
/// zero: no hand, only push_N.
struct Hand {
  double mass_kg = 0.0;
  double damping_Ns_m = 0.0;
  double stiffness_N_m = 0.0;
  double grip_N_m = 0.0;
  double grip_damping_Ns_m = 0.0;

  static constexpr Hand none() { return {}; }
  static constexpr Hand light() { return {0.15, 5.0, 200.0, 0.0, 0.0}; }
  static constexpr Hand lightGrip() { return {0.15, 5.0, 200.0, 1000.0, 3.0}; }
  static constexpr Hand firm() { return {0.30, 20.0, 800.0, 0.0, 0.0}; }
  static constexpr Hand firmGrip() { return {0.30, 20.0, 800.0, 4000.0, 10.0}; }
};

/// One axis, SI units: device x, v and hand x, v (the latter two rest when the hand is rigid or
/// absent).
class AxisPlant {
 public:
  using State = Eigen::Vector4d;
  AxisPlant(const DeviceProfile& profile, const Hand& hand) noexcept;

  void reset(double position_m, double velocity_m_s) noexcept;
  /// One tick under a constant force on the device and a hand's target that is at `target_m` and
  /// moves with `target_velocity_m_s`.
  void advance(double force_N, double target_m, double target_velocity_m_s) noexcept;
  [[nodiscard]] double position_m() const noexcept { return state_[0]; }
  [[nodiscard]] double velocity_m_s() const noexcept { return state_[1]; }

 private:
  using Input = Eigen::Vector3d;  // force on the device, target, target's velocity
  State rate(const State& state, const Input& input) const noexcept;
  State flow(const State& state, const Input& input, double time_s, bool stuck) const noexcept;
  void advanceRest(const Input& input, double time_s) noexcept;

  Eigen::Matrix4d a_;  // continuous
  Eigen::Matrix<double, 4, 3> b_;
  Eigen::Matrix4d phi_;  // over one tick
  Eigen::Matrix<double, 4, 3> gamma_;
  double moving_mass_kg_;
  double friction_N_;
  State state_ = State::Zero();
};

class VirtualDevice final : public HapticDevice {
 public:
  static constexpr int kLongestDelay_ticks = 5;

  /// `clock` outlives the device; `script` may be null (then setTarget() leads the hand) and
  /// outlives it. count_mm <= 0 in the profile: not quantised. delay_ticks is clamped to 0..5.
  /// Starts 30 mm above the middle.
  VirtualDevice(const DeviceProfile& profile, const Hand& hand, const Clock& clock,
                HandScript* script) noexcept;

  [[nodiscard]] const DeviceProfile& profile() const noexcept override { return profile_; }
  /// Absolute sleep on CLOCK_MONOTONIC. A virtual clock is advanced by hand and never waited for:
  /// whoever drives one does not call this.
  void waitForTick(LocalTime deadline) noexcept override;
  /// Lives through the ticks since the last call (one at least; a second at most), then says where
  /// it is. The force acts delay_ticks after the last position was said.
  DeviceState exchange(const Vec3& force_N) noexcept override;
  void observe(const TickReport& report) noexcept override;

  void reset(const Vec3& position_mm, const Vec3& velocity_mm_s) noexcept;
  void setTarget(const Vec3& target_mm) noexcept { target_mm_ = target_mm; }  ///< device frame
  void setPush(const Vec3& push_N) noexcept { push_N_ = push_N; }  ///< constant force of the hand
  [[nodiscard]] Vec3 truePosition_mm() const noexcept;
  [[nodiscard]] Vec3 trueVelocity_mm_s() const noexcept;

 private:
  int ticksSinceLast() noexcept;
  void advance(const Vec3& force_N, const Vec3& target_from_mm,
               const Vec3& target_velocity_mm_s) noexcept;

  DeviceProfile profile_;
  const Clock& clock_;
  HandScript* script_;
  std::array<AxisPlant, 3> axes_;
  std::array<Vec3, kLongestDelay_ticks + 1> sent_N_;  // ring
  std::size_t delay_;
  std::size_t newest_ = 0;
  bool running_ = false;
  LocalTime time_{};
  Vec3 target_mm_ = Vec3::Zero();
  Vec3 last_target_mm_ = Vec3::Zero();
  Vec3 push_N_ = Vec3::Zero();
};

}  // namespace hapticast::client
