// SPDX-License-Identifier: MIT
// Simulates one axis of a device in a hand: masses, springs, dampers and Coulomb friction. The
// solution over a tick is exact. It uses the matrix exponential, and it computes the instant at
// which the friction stops the device. A cheaper integrator would hide the instability that the
// simulation has to show.
// Thread: any, one at a time.
#pragma once

#include <Eigen/Core>

#include "client/device/profile/device_profile.hpp"

namespace hapticast::client {

/// Parameters of a simulated hand, the same on every axis. A spring and a damper pull the hand to
/// its target. If grip_N_m is 0, the hand is rigidly connected to the device, and their masses add.
/// Otherwise the spring and damper of the grip connect hand and device. If all values are zero,
/// there is no hand.
struct Hand {
  double mass_kg = 0.0;
  double damping_Ns_m = 0.0;
  double stiffness_N_m = 0.0;
  double grip_N_m = 0.0;
  double grip_damping_Ns_m = 0.0;

  /// Typical hands. The client uses light(). The others serve to measure the safety chain.
  static constexpr Hand none() { return {}; }
  static constexpr Hand light() { return {0.15, 5.0, 200.0, 0.0, 0.0}; }
  static constexpr Hand lightGrip() { return {0.15, 5.0, 200.0, 1000.0, 3.0}; }
  static constexpr Hand firm() { return {0.30, 20.0, 800.0, 0.0, 0.0}; }
  static constexpr Hand firmGrip() { return {0.30, 20.0, 800.0, 4000.0, 10.0}; }
};

/// Simulates one axis. The first two values of the state are position and velocity of the device.
/// The last two are those of the hand. All are in SI units. If the hand is rigidly connected or
/// absent, its two values do not change.
class AxisPlant {
 public:
  using State = Eigen::Vector4d;
  /// `profile` has mass, damping and friction of the device.
  AxisPlant(const PlantProfile& profile, const Hand& hand) noexcept;

  /// Sets position and velocity of device and hand.
  void reset(double position_m, double velocity_m_s) noexcept;
  /// Advances the simulation by one tick, under a constant force on the device. The hand's target
  /// is at `target_m` when the tick begins, and moves with `target_velocity_m_s`.
  void advance(double force_N, double target_m, double target_velocity_m_s) noexcept;
  [[nodiscard]] double position_m() const noexcept { return state_[0]; }
  [[nodiscard]] double velocity_m_s() const noexcept { return state_[1]; }

 private:
  using Input = Eigen::Vector3d;  // force on the device, target, velocity of the target
  State rate(const State& state, const Input& input) const noexcept;
  State flow(const State& state, const Input& input, double time_s, bool stuck) const noexcept;
  void advanceRest(const Input& input, double time_s) noexcept;

  Eigen::Matrix4d a_;  // continuous
  Eigen::Matrix<double, 4, 3> b_;
  Eigen::Matrix4d phi_;  // discrete, over one tick
  Eigen::Matrix<double, 4, 3> gamma_;
  double moving_mass_kg_;
  double friction_N_;
  State state_ = State::Zero();
};

}  // namespace hapticast::client
