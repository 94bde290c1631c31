// SPDX-License-Identifier: MIT
// One axis of a simulated device in a simulated hand. It is solved exactly over each tick (matrix
// exponential; Coulomb friction by the instant of standstill), because a cheaper integrator hides
// the very instability it is there to show. Thread: any, one at a time.
#pragma once

#include <Eigen/Core>

#include "client/device/device_profile.hpp"

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

  /// The hands of the battery; the client's is light(), the others are for measuring the chain
  /// against this very plant.
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
  AxisPlant(const PlantProfile& profile, const Hand& hand) noexcept;

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

}  // namespace hapticast::client
