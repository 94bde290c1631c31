// SPDX-License-Identifier: MIT
// Motion of the HIP. There are three estimates for three purposes:
//
// - Predicted state: an observer predicts the state of the HIP at the time when a force sent now
//   acts (hip_observer.hpp). The contact and the wall law use it.
// - Velocity: a Kalman filter with constant acceleration computes it from the measured positions
//   alone (jerk density 1e6 m²/s⁵). The limits and the energy meters use it, because no error of a
//   device model can mislead it.
// - Acceleration for the virtual inertia -m_cursor a_cursor (Eq. 13-14): it is the change of the
//   observer's velocity, after two one-pole filters of 20 Hz. A faster filter makes virtual inertia
//   unstable (client/haptics/README.md, section 2).
//
// At rest the filters decay to denormal numbers. The loop's thread treats those numbers as zero.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Constant gains of the Kalman filter at 1 kHz. The residual r is the measured position minus the
/// predicted position. Each tick adds position * r to the position, velocity_per_s * r to the
/// velocity, and acceleration_per_s2 * r to the acceleration.
struct KalmanGains {
  double position = 0.0;
  double velocity_per_s = 0.0;
  double acceleration_per_s2 = 0.0;
};
/// Returns the gains for an encoder count of `count_mm`. They are the fixed point of the Riccati
/// iteration for a jerk density of 1e6 m²/s⁵ and a measurement variance of count²/12. Requires
/// count_mm > 0.
KalmanGains steadyGains(double count_mm) noexcept;

/// The estimates of one tick. All vectors are in the device frame.
struct HipEstimate {
  /// Measured position; without a new reading it is the last valid position.
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();  ///< velocity from the measured positions alone
  HipState ahead;                     ///< predicted state, lookahead() after the reading
  Vec3 acceleration_m_s2 = Vec3::Zero();
  bool finite = true;      ///< false: the reading was NaN; position and velocity are unchanged
  bool restarted = false;  ///< this reading does not continue the motion of the reading before
  /// This reading came 1.5 ms to 1 s after the last one, and the HIP can have moved from there.
  bool late = false;
  int ticks_without_data = 0;  ///< ticks since the last valid reading
};

/// Estimates the motion of the HIP from the readings of the device and the sent forces.
class HipEstimator {
 public:
  explicit HipEstimator(const DeviceProfile& profile) noexcept;

  /// Sets the delay: the number of ticks from the reading of a position to the begin of its force.
  /// The value is clamped to 0..kMostDelay_ticks.
  void setDelay(int delay_ticks) noexcept;
  /// Returns the time from the reading to HipEstimate::ahead: the delay plus the margin of the
  /// prediction (kPredictionMargin_ticks).
  [[nodiscard]] Duration lookahead() const noexcept {
    return (delay_ticks_ + kPredictionMargin_ticks) * kTickPeriod;
  }
  /// Records the force that was sent to the device since the last update(). `wall_N_mm` is the
  /// stiffness of the wall in contact. Call it before each update().
  void sent(const Vec3& force_N, double wall_N_mm) noexcept;
  /// Processes the reading of one tick and returns the new estimates.
  ///
  /// After a gap of 1.5 to 20 ms between two readings, the velocity is the mean velocity over the
  /// gap. The estimates restart from rest in three cases: the time did not increase, the gap is
  /// longer than 20 ms, or the motion is faster than 10 m/s. A missing or NaN reading leaves
  /// position, velocity and acceleration unchanged.
  const HipEstimate& update(const DeviceState& state) noexcept;

 private:
  void restart(const DeviceState& state) noexcept;
  void onPosition(const Vec3& measured_mm) noexcept;
  void bridge(const Vec3& measured_mm, double gap_s) noexcept;
  void filterAcceleration(const Vec3& raw_m_s2) noexcept;

  /// Returns the force that acted during the last tick.
  [[nodiscard]] Vec3 acting_N() const noexcept { return sent_.ago(1 + delay_ticks_); }

  KalmanGains gains_;
  HipObserver observer_;
  SentForces sent_;
  double wall_N_mm_;
  int delay_ticks_ = 0;
  HipEstimate estimate_;
  bool running_ = false;
  LocalTime last_time_{};
  Vec3 x_mm_ = Vec3::Zero();  // Kalman state
  Vec3 a_mm_s2_ = Vec3::Zero();
  Vec3 smooth_m_s2_ = Vec3::Zero();  // after the first of the two one-pole filters
};

}  // namespace hapticast::client
