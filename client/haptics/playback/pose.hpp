// SPDX-License-Identifier: MIT
// The pose of one object between and beyond its frames. Real-time room: noexcept, no heap, no
// locks. Times are seconds after the earlier frame.
#pragma once

#include <array>
#include <cstddef>

#include "client/haptics/playback/frame_pool.hpp"

namespace hapticast::client {

/// Units as in Motion (nominal mm, s, rad).
struct Pose {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 acceleration_mm_s2 = Vec3::Zero();
  double angle_rad = 0.0;
  double angular_velocity_rad_s = 0.0;
};

/// b - a in seconds; any two times.
double secondsBetween(MediaTime a, MediaTime b) noexcept;

/// The turn from one frame to the next, the short way round.
double rotationBetween(const Motion& from, const Motion& to) noexcept;

/// As sent in the frame, standing still.
Pose restingPose(const Motion& motion) noexcept;
/// Linear in position, angle and acceleration. Requires interval_s > 0.
Pose linearPose(const Motion& from, const Motion& to, double interval_s, double time_s) noexcept;
/// The object's changes of velocity that are known within an interval.
struct VelocityJumps {
  struct VelocityJump {
    double time_s = 0.0;
    Vec3 delta_mm_s = Vec3::Zero();
  };
  std::array<VelocityJump, kMaxImpacts> at{};
  std::size_t count = 0;

  /// What they have moved the object by until then, and how fast.
  [[nodiscard]] Vec3 displacement(double time_s) const noexcept;
  [[nodiscard]] Vec3 velocity(double time_s) const noexcept;
};

/// Cubic Hermite of (p, v), acceleration linear. An impact inside the interval puts its kink where
/// it happened: the Hermite is laid through what is left when the kink is taken out of both ends,
/// and the kink is added back, which is exact for a ballistic bounce. Impacts that would explain
/// none of the change of velocity are ignored. All that the pair of frames decides is computed
/// once, by the constructor.
class HermitePath {
 public:
  HermitePath() = default;
  /// Requires interval_s > 0.
  HermitePath(const PlayObject& from, const PlayObject& to, MediaTime from_time,
              double interval_s) noexcept;
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
  double rate_1_s_ = 1.0;  // 1 / interval
  bool turns_ = false;
  VelocityJumps kinks_;
};

/// Carried on with v (and through known impacts) until limit_s, then standing still; the
/// acceleration ramps from the sent one to 0 meanwhile.
Pose deadReckonedPose(const PlayObject& from, MediaTime from_time, double limit_s,
                      double time_s) noexcept;

}  // namespace hapticast::client
