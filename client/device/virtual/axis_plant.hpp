// SPDX-License-Identifier: MIT
// One axis of a simulated device in a simulated hand. The solution over a tick is exact: matrix
// exponential, and Coulomb friction by the instant of standstill. A cheaper integrator hides the
// instability that the simulation has to show.
// Thread: any, one at a time.
#pragma once

#include <Eigen/Core>

#include "client/device/device_profile.hpp"

namespace hapticast::client {

/// A hand, equal on every axis. With grip_N_m = 0 it holds the device rigidly, and the masses add.
/// Otherwise spring and damper of the grip lie in between. Its own spring and damper pull it to the
/// target. All zero: no hand, only a push force.
struct Hand {
  double mass_kg = 0.0;
  double damping_Ns_m = 0.0;
  double stiffness_N_m = 0.0;
  double grip_N_m = 0.0;
  double grip_damping_Ns_m = 0.0;

  /// The hands of the stability battery. The client uses light(); the others serve to measure the
  /// safety chain.
  static constexpr Hand none() { return {}; }
  static constexpr Hand light() { return {0.15, 5.0, 200.0, 0.0, 0.0}; }
  static constexpr Hand lightGrip() { return {0.15, 5.0, 200.0, 1000.0, 3.0}; }
  static constexpr Hand firm() { return {0.30, 20.0, 800.0, 0.0, 0.0}; }
  static constexpr Hand firmGrip() { return {0.30, 20.0, 800.0, 4000.0, 10.0}; }
};

/// State in SI units: x, v of the device and x, v of the hand. The latter two are at rest for a
/// rigid or absent hand.
class AxisPlant {
 public:
  using State = Eigen::Vector4d;
  AxisPlant(const PlantProfile& profile, const Hand& hand) noexcept;

  /// Places device and hand.
  void reset(double position_m, double velocity_m_s) noexcept;
  /// Advances one tick under a constant force on the device. The hand's target is at `target_m` and
  /// moves with `target_velocity_m_s`.
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
