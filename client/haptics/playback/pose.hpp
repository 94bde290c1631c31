// SPDX-License-Identifier: MIT
// Pose of one object between its frames and beyond them: cubic Hermite interpolation with impacts,
// linear interpolation, and dead reckoning. Times are seconds after the earlier frame.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>

#include "client/haptics/playback/frame_pool.hpp"

namespace hapticast::client {

/// Pose and its derivatives; units as in Motion (nominal mm, s, rad).
struct Pose {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;
  double angular_velocity_rad_s = 0.0;
};

/// Returns b - a in seconds, for any two times.
double secondsBetween(MediaTime a, MediaTime b) noexcept;

/// Returns the turn from one frame to the next, the shorter of both directions: -pi..pi.
double rotationBetween(const Motion& from, const Motion& to) noexcept;

/// Returns the pose of the frame, at rest, with its acceleration.
Pose restingPose(const Motion& motion) noexcept;
/// Linear interpolation of position, angle and acceleration. Requires interval_s > 0.
Pose linearPose(const Motion& from, const Motion& to, double interval_s, double time_s) noexcept;
/// The impacts of an object within an interval.
struct VelocityJumps {
  struct VelocityJump {
    double time_s = 0.0;
    Vec3 delta_mm_s = Vec3::Zero();
  };
  std::array<VelocityJump, kMaxImpacts> at{};
  std::size_t count = 0;

  /// Returns the displacement (mm) and the velocity (mm/s) that the impacts up to `time_s` have
  /// caused.
  [[nodiscard]] Vec3 displacement(double time_s) const noexcept;
  [[nodiscard]] Vec3 velocity(double time_s) const noexcept;
};

/// Cubic Hermite path of (p, v), with linear acceleration.
///
/// An impact inside the interval causes a kink at its time. The path subtracts the kink from both
/// ends, interpolates the rest, and adds the kink again. That is exact for a ballistic bounce.
/// Impacts that explain no part of the change of velocity are ignored. The constructor computes all
/// coefficients.
class HermitePath {
 public:
  HermitePath() = default;
  /// Requires interval_s > 0 and two frames of the same object.
  HermitePath(const PlayObject& from, const PlayObject& to, MediaTime from_time,
              double interval_s) noexcept;
  /// Returns the pose at `time_s`, 0..interval_s.
  [[nodiscard]] Pose at(double time_s) const noexcept;

 private:
  /// Value and rate at both ends.
  template <class T>
  struct Ends {
    T p0, v0, p1, v1;
  };
  Ends<Vec3> path_;  // without the kinks
  Ends<double> angle_{};
  Vec3 acceleration_mm_s2_ = Vec3::Zero();
  Vec3 acceleration_change_mm_s2_ = Vec3::Zero();
  double interval_s_ = 1.0;
  double rate_1_s_ = 1.0;  // 1 / interval_s_
  bool turns_ = false;
  VelocityJumps kinks_;
};

/// Dead reckoning: extrapolates with v, and through the impacts of the frame, until limit_s. Then
/// the object rests. The acceleration ramps to 0 until limit_s. Requires limit_s > 0.
Pose deadReckonedPose(const PlayObject& from, MediaTime from_time, double limit_s,
                      double time_s) noexcept;

}  // namespace hapticast::client
