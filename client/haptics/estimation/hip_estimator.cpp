// SPDX-License-Identifier: MIT
#include "client/haptics/estimation/hip_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/haptics/haptic_device.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {
// Measured: allows the stiffest wall of all filters in the comparison.
constexpr double kJerkDensity_m2_s5 = 1e6;
constexpr double kLateTick_s = 1.5e-3;   // chosen: the loop counts late ticks by the same limit
constexpr double kLongestGap_s = 20e-3;  // chosen
constexpr double kLongestWay_s = 1.0;    // chosen: the meters count the way through a shorter gap
// Above any hand: the device was homed again, or reports nonsense.
constexpr double kFastest_mm_s = 10'000.0;
const double kOnePole20Hz = 1.0 - std::exp(-2.0 * std::numbers::pi * 20.0 * kTick_s);
}  // namespace

KalmanGains steadyGains(double count_mm) noexcept {
  using Mat3 = Eigen::Matrix3d;
  constexpr double t = kTick_s;
  const double variance = count_mm * count_mm * 1e-6 / 12.0;  // m²
  Mat3 transition;
  transition << 1.0, t, t * t / 2.0, 0.0, 1.0, t, 0.0, 0.0, 1.0;
  Mat3 noise;
  noise << t * t * t * t * t / 20.0, t * t * t * t / 8.0, t * t * t / 6.0,  //
      t * t * t * t / 8.0, t * t * t / 3.0, t * t / 2.0,                    //
      t * t * t / 6.0, t * t / 2.0, t;
  noise *= kJerkDensity_m2_s5;
  Mat3 covariance = noise;
  Vec3 gain = Vec3::Zero();
  for (int i = 0; i < 500; ++i) {  // converges within about 30 steps for any count
    const Mat3 predicted = transition * covariance * transition.transpose() + noise;
    gain = predicted.col(0) / (predicted(0, 0) + variance);
    covariance = predicted - gain * predicted.row(0);
  }
  return {gain.x(), gain.y(), gain.z()};
}

HipEstimator::HipEstimator(const DeviceProfile& profile) noexcept
    : gains_(steadyGains(profile.count_mm)),
      observer_(profile),
      wall_N_mm_(profile.stiffness_N_mm) {
  setDelay(profile.delay_ticks);
}

void HipEstimator::setDelay(int delay_ticks) noexcept {
  delay_ticks_ = std::clamp(delay_ticks, 0, kMostDelay_ticks);
}

void HipEstimator::sent(const Vec3& force_N, double wall_N_mm) noexcept {
  sent_.add(force_N);
  wall_N_mm_ = wall_N_mm;
}

const HipEstimate& HipEstimator::update(const DeviceState& state) noexcept {
  estimate_.restarted = estimate_.late = false;
  estimate_.finite = state.position_mm.allFinite();
  if (state.status != DeviceStatus::kOk || !estimate_.finite) {
    ++estimate_.ticks_without_data;
    return estimate_;
  }
  estimate_.ticks_without_data = 0;
  const double gap_s = toSeconds(state.time - last_time_);
  const double path_mm = (state.position_mm - estimate_.position_mm).norm();
  if (!running_ || gap_s <= 0.0 || gap_s > kLongestGap_s || path_mm > kFastest_mm_s * gap_s) {
    const bool continues = running_ && gap_s > kLongestGap_s && gap_s < kLongestWay_s &&
                           path_mm <= kFastest_mm_s * gap_s;
    restart(state);
    estimate_.late = continues;
  } else if (gap_s > kLateTick_s) {
    bridge(state.position_mm, gap_s);
  } else {
    onPosition(state.position_mm);
  }
  last_time_ = state.time;
  estimate_.position_mm = state.position_mm;
  estimate_.ahead = observer_.predictAhead(sent_, delay_ticks_);
  return estimate_;
}

void HipEstimator::restart(const DeviceState& state) noexcept {
  running_ = true;
  estimate_.restarted = true;
  estimate_.velocity_mm_s = estimate_.acceleration_m_s2 = Vec3::Zero();
  x_mm_ = state.position_mm;
  a_mm_s2_ = smooth_m_s2_ = Vec3::Zero();
  observer_.restart({state.position_mm, Vec3::Zero()}, acting_N());
}

void HipEstimator::onPosition(const Vec3& measured_mm) noexcept {
  Vec3& v_mm_s = estimate_.velocity_mm_s;
  x_mm_ += v_mm_s * kTick_s + a_mm_s2_ * (kTick_s * kTick_s / 2.0);
  v_mm_s += a_mm_s2_ * kTick_s;
  const Vec3 residual_mm = measured_mm - x_mm_;
  x_mm_ += gains_.position * residual_mm;
  v_mm_s += gains_.velocity_per_s * residual_mm;
  a_mm_s2_ += gains_.acceleration_per_s2 * residual_mm;

  const Vec3 before_mm_s = observer_.tip().velocity_mm_s;
  observer_.update(measured_mm, acting_N(), wall_N_mm_);
  filterAcceleration((observer_.tip().velocity_mm_s - before_mm_s) / (kTick_s * 1000.0));
}

// Uses the mean velocity over the gap, which is certain. A prediction through the gap would cause a
// spike by the old acceleration.
void HipEstimator::bridge(const Vec3& measured_mm, double gap_s) noexcept {
  estimate_.late = true;
  x_mm_ = measured_mm;
  estimate_.velocity_mm_s = (measured_mm - estimate_.position_mm) / gap_s;
  a_mm_s2_ = Vec3::Zero();
  observer_.restart({measured_mm, estimate_.velocity_mm_s}, acting_N());
  filterAcceleration(Vec3::Zero());
}

void HipEstimator::filterAcceleration(const Vec3& raw_m_s2) noexcept {
  smooth_m_s2_ += kOnePole20Hz * (raw_m_s2 - smooth_m_s2_);
  estimate_.acceleration_m_s2 += kOnePole20Hz * (smooth_m_s2_ - estimate_.acceleration_m_s2);
}

}  // namespace hapticast::client
