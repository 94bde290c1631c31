// SPDX-License-Identifier: MIT
#include "client/device/virtual/axis_plant.hpp"

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
using Matrix7 = Eigen::Matrix<double, 7, 7>;

double sign(double x) noexcept { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }
}  // namespace

AxisPlant::AxisPlant(const PlantProfile& profile, const Hand& hand) noexcept
    : friction_N_(profile.friction_N) {
  const bool grip = hand.grip_N_m > 0.0;
  moving_mass_kg_ = profile.mass_kg + (grip ? 0.0 : hand.mass_kg);
  a_.setZero();
  b_.setZero();
  const double k = hand.stiffness_N_m;
  const double c = hand.damping_Ns_m;
  a_(0, 1) = 1.0;
  b_(1, 0) = 1.0 / moving_mass_kg_;
  if (grip) {
    const double kg = hand.grip_N_m;
    const double cg = hand.grip_damping_Ns_m;
    a_.row(1) << -kg, -(profile.damping_Ns_m + cg), kg, cg;
    a_(2, 3) = 1.0;
    a_.row(3) << kg, cg, -(kg + k), -(cg + c);
    a_.row(3) /= hand.mass_kg;
    b_.row(3) << 0.0, k / hand.mass_kg, c / hand.mass_kg;
  } else {
    a_.row(1) << -k, -(profile.damping_Ns_m + c), 0.0, 0.0;
    b_(1, 1) = k / moving_mass_kg_;
    b_(1, 2) = c / moving_mass_kg_;
  }
  a_.row(1) /= moving_mass_kg_;

  // [x; u]' = [A B; 0 S] [x; u]: the force is constant, the target moves with its velocity.
  Matrix7 whole = Matrix7::Zero();
  whole.topLeftCorner<4, 4>() = a_ * kTick_s;
  whole.topRightCorner<4, 3>() = b_ * kTick_s;
  whole(5, 6) = kTick_s;
  const Matrix7 exact = whole.exp();
  phi_ = exact.topLeftCorner<4, 4>();
  gamma_ = exact.topRightCorner<4, 3>();
}

void AxisPlant::reset(double position_m, double velocity_m_s) noexcept {
  state_ << position_m, velocity_m_s, position_m, velocity_m_s;
}

AxisPlant::State AxisPlant::rate(const State& state, const Input& input) const noexcept {
  return a_ * state + b_ * input;
}

/// Returns the state after a part of a tick, by the Taylor series of the exact flow. `stuck`: the
/// device is at rest.
AxisPlant::State AxisPlant::flow(const State& state, const Input& input, double time_s,
                                 bool stuck) const noexcept {
  constexpr int kTerms = 8;
  State sum = state;
  State derivative = rate(state, input);
  Input input_rate(0.0, input[2], 0.0);
  double factor = 1.0;
  for (int i = 1; i <= kTerms; ++i) {
    if (stuck) derivative.head<2>().setZero();
    factor *= time_s / i;
    sum += factor * derivative;
    derivative = a_ * derivative + b_ * input_rate;
    input_rate.setZero();
  }
  return sum;
}

void AxisPlant::advance(double force_N, double target_m, double target_velocity_m_s) noexcept {
  Input input(force_N, target_m, target_velocity_m_s);
  if (friction_N_ <= 0.0) {
    state_ = phi_ * state_ + gamma_ * input;
    return;
  }
  const double v = state_[1];
  if (v == 0.0) {
    advanceRest(input, kTick_s);
    return;
  }
  Input rubbed = input;
  rubbed[0] -= friction_N_ * sign(v);
  const State free = phi_ * state_ + gamma_ * rubbed;
  if (sign(free[1]) == sign(v)) {
    state_ = free;
    return;
  }
  // The device stops inside the tick, at the linear crossing. Then it sticks or moves the other
  // way.
  const double stop_s = kTick_s * v / (v - free[1]);
  state_ = flow(state_, rubbed, stop_s, false);
  state_[1] = 0.0;
  input[1] += target_velocity_m_s * stop_s;
  advanceRest(input, kTick_s - stop_s);
}

/// Advances from rest: sticks while friction balances the net force, else slides.
void AxisPlant::advanceRest(const Input& input, double time_s) noexcept {
  const double net_N = rate(state_, input)[1] * moving_mass_kg_;
  if (std::abs(net_N) <= friction_N_) {
    state_ = flow(state_, input, time_s, true);
    return;
  }
  Input rubbed = input;
  rubbed[0] -= friction_N_ * sign(net_N);
  state_ = flow(state_, rubbed, time_s, false);
}

}  // namespace hapticast::client
