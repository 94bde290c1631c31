// SPDX-License-Identifier: MIT
// How the tip moves: two filters for two jobs. A fast constant-acceleration Kalman filter (jerk
// density 1e6) gives the velocity for damping; twice-filtered differences (2 x 20 Hz, Eq. 13-14)
// give the acceleration for -m_cursor a_cursor, because a faster filter there makes virtual inertia
// unstable. Real-time room.
#pragma once

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
  Vec3 position_mm = Vec3::Zero();  ///< as measured (the last good one when there is none)
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_m_s2 = Vec3::Zero();
  bool finite = true;          ///< false: the device said NaN; position and velocity are kept
  bool restarted = false;      ///< this sample cannot be connected with the one before
  int ticks_without_data = 0;  ///< since the last good sample
};

class HipMotion {
 public:
  explicit HipMotion(double count_mm) noexcept;

  /// One tick. A gap of 1.5-20 ms is bridged by the mean velocity; dt <= 0, dt > 20 ms or more than
  /// 10 m/s start over from rest. NaN or no new data: everything is kept.
  const HipEstimate& update(const DeviceState& state) noexcept;

 private:
  void restart(const DeviceState& state) noexcept;
  void follow(const Vec3& measured_mm) noexcept;
  void bridge(const Vec3& measured_mm, double gap_s) noexcept;
  void filterAcceleration(const Vec3& raw_m_s2) noexcept;

  KalmanGains gains_;
  HipEstimate estimate_;
  bool running_ = false;
  LocalTime last_time_{};
  Vec3 x_mm_ = Vec3::Zero();  // Kalman state
  Vec3 a_mm_s2_ = Vec3::Zero();
  Vec3 difference_mm_s_ = Vec3::Zero();  // last first difference
  Vec3 smooth_m_s2_ = Vec3::Zero();      // after the first of the two one-poles
};

}  // namespace hapticast::client
