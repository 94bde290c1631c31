// SPDX-License-Identifier: MIT
// Motion of the HIP: three estimates for three purposes.
//
// - Ahead: an observer predicts the state of the HIP when a force sent now acts (hip_observer.hpp).
// The contact and
//   the wall use it.
// - Velocity from the counts alone: a constant-acceleration Kalman filter (jerk density 1e6 m²/s⁵).
// Limits and
//   meters use it, because no model error can mislead it.
// - Acceleration for -m_cursor a_cursor (Eq. 13-14): the difference of the observer's velocity
// through two one-pole
//   filters of 20 Hz. A faster filter makes virtual inertia unstable (client/haptics/README.md,
//   section 2).
//
// At rest the filters decay to denormal numbers; the loop's thread flushes them to zero.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Stationary gains of the Kalman filter at 1 kHz: x += k1 r; v += k2 r; a += k3 r.
struct KalmanGains {
  double position = 0.0;
  double velocity_per_s = 0.0;
  double acceleration_per_s2 = 0.0;
};
/// Returns the fixed point of the Riccati iteration for a jerk density of 1e6 m²/s⁵ and a
/// measurement variance of count²/12. Requires count_mm > 0.
KalmanGains steadyGains(double count_mm) noexcept;

/// The estimates of a tick, device frame.
struct HipEstimate {
  Vec3 position_mm = Vec3::Zero();    ///< as measured; without a reading the last valid position
  Vec3 velocity_mm_s = Vec3::Zero();  ///< from the counts alone
  HipState ahead;                     ///< predicted state when a force sent now acts
  Vec3 acceleration_m_s2 = Vec3::Zero();
  bool finite = true;          ///< false: the reading was NaN; position and velocity are unchanged
  bool restarted = false;      ///< this reading has no connection with the one before
  int ticks_without_data = 0;  ///< ticks since the last valid reading
};

/// Estimates the motion of the HIP from the readings of the device and the sent forces.
class HipEstimator {
 public:
  explicit HipEstimator(const DeviceProfile& profile) noexcept;

  /// Sets the ticks between reading a position and the begin of its force, clamped to
  /// 0..kMostDelay_ticks.
  void setDelay(int delay_ticks) noexcept;
  /// Records the force sent to the device since the last update(), and the stiffness of the wall in
  /// contact. Call before each update().
  void sent(const Vec3& force_N, double wall_N_mm) noexcept;
  /// Processes the reading of one tick. A gap of 1.5-20 ms uses the mean velocity. dt <= 0, dt > 20
  /// ms or more than 10 m/s restart the estimates from rest. NaN or a missing reading leaves them
  /// unchanged.
  const HipEstimate& update(const DeviceState& state) noexcept;

 private:
  void restart(const DeviceState& state) noexcept;
  void onPosition(const Vec3& measured_mm) noexcept;
  void bridge(const Vec3& measured_mm, double gap_s) noexcept;
  void filterAcceleration(const Vec3& raw_m_s2) noexcept;

  /// The force that acted during the last tick.
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
