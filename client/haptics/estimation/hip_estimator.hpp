// SPDX-License-Identifier: MIT
// How the tip moves, for three jobs. Where a force that is sent now will find it: an observer that
// knows the forces sent before (tip_observer.hpp); the wall is touched there. What the counts alone
// say of its velocity: a fast constant-acceleration Kalman filter (jerk density 1e6), which no
// model can mislead, for limits and meters. The acceleration for -m_cursor a_cursor: the observer's
// velocity, differenced and twice filtered (2 x 20 Hz, Eq. 13-14), because a faster filter makes
// virtual inertia unstable (README.md). At rest filters decay to denormals, which the loop's thread
// flushes. Real-time room.
#pragma once

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Steady gains of the Kalman filter at 1 kHz: x += k1 r; v += k2 r; a += k3 r.
struct KalmanGains {
  double position = 0.0;
  double velocity_per_s = 0.0;
  double acceleration_per_s2 = 0.0;
};
/// Fixed point of the Riccati iteration for jerk density 1e6 m²/s⁵ and a measurement variance
/// count²/12. Requires count_mm > 0.
KalmanGains steadyGains(double count_mm) noexcept;

/// Device frame.
struct HipEstimate {
  Vec3 position_mm = Vec3::Zero();    ///< as measured (the last good one when there is none)
  Vec3 velocity_mm_s = Vec3::Zero();  ///< by the counts alone
  HipState ahead;                     ///< where a force that is sent now will find the tip
  Vec3 acceleration_m_s2 = Vec3::Zero();
  bool finite = true;          ///< false: the device said NaN; position and velocity are kept
  bool restarted = false;      ///< this sample cannot be connected with the one before
  int ticks_without_data = 0;  ///< since the last good sample
};

class HipEstimator {
 public:
  explicit HipEstimator(const DeviceProfile& profile) noexcept;

  /// Ticks between reading a position and the begin of its force (0..kMostDelay_ticks).
  void setDelay(int delay_ticks) noexcept;
  /// Before update: what was sent to the device since the last one, as it was sent, and the
  /// stiffness of the wall it may touch.
  void sent(const Vec3& force_N, double wall_N_mm) noexcept;
  /// One tick. A gap of 1.5-20 ms is bridged by the mean velocity; dt <= 0, dt > 20 ms or more than
  /// 10 m/s start over from rest. NaN or no new data: everything is kept.
  const HipEstimate& update(const DeviceState& state) noexcept;

 private:
  void restart(const DeviceState& state) noexcept;
  void onPosition(const Vec3& measured_mm) noexcept;
  void bridge(const Vec3& measured_mm, double gap_s) noexcept;
  void filterAcceleration(const Vec3& raw_m_s2) noexcept;

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
  Vec3 smooth_m_s2_ = Vec3::Zero();  // after the first of the two one-poles
};

}  // namespace hapticast::client
