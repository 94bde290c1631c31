// SPDX-License-Identifier: MIT
// Pose of one object at an instant between two frames, or beyond the newest frame. There are three
// methods: cubic Hermite interpolation with impacts, linear interpolation, and dead reckoning.
// Times are seconds after the earlier frame.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>

#include "client/haptics/playback/frame_pool.hpp"

namespace hapticast::client {

/// Pose of an object and its derivatives. The units are those of Motion (nominal mm, s, rad).
struct Pose {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;
  double angular_velocity_rad_s = 0.0;
};

/// Returns b - a in seconds. The result is correct for any two times, even if their difference
/// exceeds 64 bits.
double secondsBetween(MediaTime a, MediaTime b) noexcept;

/// Returns the rotation of the object from one frame to the next, -pi..pi. It is the shorter of the
/// two possible rotations.
double rotationBetween(const Motion& from, const Motion& to) noexcept;

/// Returns the position, the angle and the acceleration of `motion`, with velocities of 0.
Pose restingPose(const Motion& motion) noexcept;
/// Returns the pose by linear interpolation of position, angle and acceleration. `interval_s` is
/// the time from the frame of `from` to that of `to`, and it must be above 0. `time_s` is the time
/// after the frame of `from`.
Pose linearPose(const Motion& from, const Motion& to, double interval_s, double time_s) noexcept;
/// The impacts of an object between two frames, as changes of its velocity.
struct VelocityJumps {
  struct VelocityJump {
    double time_s = 0.0;
    Vec3 delta_mm_s = Vec3::Zero();
  };
  std::array<VelocityJump, kMaxImpacts> at{};
  std::size_t count = 0;

  /// Return the displacement (mm) and the velocity (mm/s) that the impacts until `time_s` have
  /// added to the object's motion.
  [[nodiscard]] Vec3 displacement(double time_s) const noexcept;
  [[nodiscard]] Vec3 velocity(double time_s) const noexcept;
};

/// Path of an object between two frames: a cubic Hermite curve through the positions and velocities
/// of both frames. The acceleration is linear between the two.
///
/// An impact between the frames causes a kink of the path at the time of the impact. The
/// constructor subtracts the effect of the kinks from the second frame before it fits the curve.
/// at() adds the effect again. That is exact for a ballistic bounce. The path ignores an impact
/// that explains no part of the change of velocity.
class HermitePath {
 public:
  HermitePath() = default;
  /// Computes all coefficients of the path. `from` and `to` are the same object in two frames,
  /// `interval_s` apart. `from_time` is the media time of the first frame. Requires interval_s > 0.
  HermitePath(const PlayObject& from, const PlayObject& to, MediaTime from_time,
              double interval_s) noexcept;
  /// Returns the pose at `time_s`, 0..interval_s after the first frame.
  [[nodiscard]] Pose at(double time_s) const noexcept;

 private:
  /// A value and its rate of change at both frames: p0 and v0 at the first one, p1 and v1 at the
  /// second one. The type T is Vec3 for the position and double for the angle.
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

/// Returns the pose `time_s` after the frame of `from`, by dead reckoning. `from_time` is the media
/// time of that frame. Its velocity and its impacts move the object until `limit_s`. After that the
/// object rests. The acceleration falls linearly to 0 until `limit_s`. Requires limit_s > 0.
Pose deadReckonedPose(const PlayObject& from, MediaTime from_time, double limit_s,
                      double time_s) noexcept;

}  // namespace hapticast::client
