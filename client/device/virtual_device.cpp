// SPDX-License-Identifier: MIT
#include "client/device/virtual_device.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "client/haptics/hip_motion.hpp"
#include "client/haptics/tick_report.hpp"
#include "common/tick.hpp"

namespace hapticast::client {

namespace {
constexpr int kLongestCatchUp_ticks = 1000;

using Matrix7 = Eigen::Matrix<double, 7, 7>;

/// exp(m) by scaling and squaring with a Taylor series: to rounding for the norms of hands and
/// devices.
Matrix7 exponential(const Matrix7& m) noexcept {
  int halvings = 0;
  for (double size = m.cwiseAbs().rowwise().sum().maxCoeff(); size > 0.25 && halvings < 60;
       size /= 2)
    ++halvings;
  const Matrix7 small = m * std::ldexp(1.0, -halvings);
  Matrix7 term = Matrix7::Identity();
  Matrix7 sum = term;
  for (int i = 1; i <= 14; ++i) {
    term = term * small / i;
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum;
}

double sign(double x) noexcept { return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : 0.0; }
}  // namespace

AxisPlant::AxisPlant(const DeviceProfile& profile, const Hand& hand) noexcept
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

  // [x; u]' = [A B; 0 S] [x; u]: the force is held, the target moves with its velocity.
  Matrix7 whole = Matrix7::Zero();
  whole.topLeftCorner<4, 4>() = a_ * kTick_s;
  whole.topRightCorner<4, 3>() = b_ * kTick_s;
  whole(5, 6) = kTick_s;
  const Matrix7 exact = exponential(whole);
  phi_ = exact.topLeftCorner<4, 4>();
  gamma_ = exact.topRightCorner<4, 3>();
}

void AxisPlant::reset(double position_m, double velocity_m_s) noexcept {
  state_ << position_m, velocity_m_s, position_m, velocity_m_s;
}

AxisPlant::State AxisPlant::rate(const State& state, const Input& input) const noexcept {
  return a_ * state + b_ * input;
}

/// The state after a part of a tick, by the Taylor series of the exact flow; stuck: the device
/// stands.
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
  // It stops inside the tick: at the linear crossing; then it sticks or starts the other way.
  const double stop_s = kTick_s * v / (v - free[1]);
  state_ = flow(state_, rubbed, stop_s, false);
  state_[1] = 0.0;
  input[1] += target_velocity_m_s * stop_s;
  advanceRest(input, kTick_s - stop_s);
}

/// From standstill: sticks while friction holds the net force, else slides its way.
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

VirtualDevice::VirtualDevice(const DeviceProfile& profile, const Hand& hand, const Clock& clock,
                             HandScript* script) noexcept
    : profile_(profile),
      clock_(clock),
      script_(script),
      axes_{AxisPlant(profile, hand), AxisPlant(profile, hand), AxisPlant(profile, hand)},
      delay_(static_cast<std::size_t>(std::clamp(profile.delay_ticks, 0, kLongestDelay_ticks))) {
  sent_N_.fill(Vec3::Zero());
  reset({0.0, 0.0, 30.0}, Vec3::Zero());
}

void VirtualDevice::waitForTick(LocalTime deadline) noexcept {
  if (clock_.now() >= deadline) return;
  const auto since = deadline.time_since_epoch().count();
  const timespec until{static_cast<time_t>(since / 1'000'000'000), since % 1'000'000'000};
  // Interrupted by a signal: sleep on until the same absolute time.
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

DeviceState VirtualDevice::exchange(const Vec3& force_N) noexcept {
  const int ticks = ticksSinceLast();
  const Vec3 velocity_mm_s = (target_mm_ - last_target_mm_) / (ticks * kTick_s);
  for (int i = 0; i < ticks; ++i) {
    newest_ = (newest_ + 1) % sent_N_.size();
    sent_N_[newest_] = force_N;
    const Vec3& acting_N = sent_N_[(newest_ + sent_N_.size() - delay_) % sent_N_.size()];
    advance(acting_N, last_target_mm_ + velocity_mm_s * (i * kTick_s), velocity_mm_s);
  }
  last_target_mm_ = target_mm_;
  DeviceState state;
  state.position_mm = truePosition_mm();
  const double count_mm = profile_.count_mm;
  if (count_mm > 0.0) state.position_mm = (state.position_mm / count_mm).array().round() * count_mm;
  state.time = time_;
  return state;
}

/// Whole ticks of the clock since the last call. One at least: a device that wakes early or late
/// within its tick must neither stand still nor live twice.
int VirtualDevice::ticksSinceLast() noexcept {
  const LocalTime now = clock_.now();
  if (!running_) {
    running_ = true;
    time_ = now - kTickPeriod;
  }
  const auto ticks = std::max<std::int64_t>((now - time_) / kTickPeriod, 1);
  if (ticks > kLongestCatchUp_ticks) {
    time_ = now;
    return kLongestCatchUp_ticks;
  }
  time_ += ticks * kTickPeriod;
  return static_cast<int>(ticks);
}

void VirtualDevice::advance(const Vec3& force_N, const Vec3& target_from_mm,
                            const Vec3& target_velocity_mm_s) noexcept {
  for (int i = 0; i < 3; ++i) {
    axes_[static_cast<std::size_t>(i)].advance(force_N[i] + push_N_[i], target_from_mm[i] * 1e-3,
                                               target_velocity_mm_s[i] * 1e-3);
  }
}

void VirtualDevice::observe(const TickReport& report) noexcept {
  if (script_ == nullptr) return;
  const Vec3 start_mm = report.mapping.toNominal(truePosition_mm());
  target_mm_ = report.mapping.toDevice(script_->next(report, start_mm));
}

void VirtualDevice::reset(const Vec3& position_mm, const Vec3& velocity_mm_s) noexcept {
  for (int i = 0; i < 3; ++i) {
    axes_[static_cast<std::size_t>(i)].reset(position_mm[i] * 1e-3, velocity_mm_s[i] * 1e-3);
  }
  target_mm_ = last_target_mm_ = position_mm;
}

Vec3 VirtualDevice::truePosition_mm() const noexcept {
  return 1e3 * Vec3(axes_[0].position_m(), axes_[1].position_m(), axes_[2].position_m());
}

Vec3 VirtualDevice::trueVelocity_mm_s() const noexcept {
  return 1e3 * Vec3(axes_[0].velocity_m_s(), axes_[1].velocity_m_s(), axes_[2].velocity_m_s());
}

}  // namespace hapticast::client
