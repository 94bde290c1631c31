// SPDX-License-Identifier: MIT
#include "client/haptics/playback/pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticast::client {

namespace {

// A velocity counts as sent while it moves the object by less than kPlausibleFactor times the
// distance of the two frames, plus a margin. Any motion between two frames is below that, including
// a reversal.
constexpr double kPlausibleFactor = 3.0;
constexpr double kPlausible_mm = 4.0;
constexpr double kPlausible_rad = 0.5;

/// Returns the impacts of `object` strictly inside (0, interval_s).
VelocityJumps findKinks(const PlayObject& object, MediaTime from_time, double interval_s) noexcept {
  VelocityJumps kinks;
  for (std::size_t i = 0; i < std::min(object.impact_count, kMaxImpacts); ++i) {
    const double time_s = secondsBetween(from_time, object.impacts[i].time);
    if (time_s <= 0.0 || time_s >= interval_s) continue;
    kinks.at[kinks.count++] = {time_s, object.impacts[i].delta_velocity_mm_s};
  }
  return kinks;
}

/// Removes the kinks that explain no part of the change of velocity.
VelocityJumps plausible(const VelocityJumps& kinks, Vec3 change_mm_s) noexcept {
  VelocityJumps kept;
  for (std::size_t i = 0; i < kinks.count; ++i) {
    const Vec3 rest = change_mm_s - kinks.at[i].delta_mm_s;
    if (rest.squaredNorm() >= change_mm_s.squaredNorm()) continue;
    change_mm_s = rest;
    kept.at[kept.count++] = kinks.at[i];
  }
  return kept;
}

/// Returns the factor (0..1) that shortens an implausible velocity.
double shortening(double distance, double displacement, double margin) noexcept {
  const double limit = kPlausibleFactor * displacement + margin;
  return distance > limit ? limit / distance : 1.0;
}

}  // namespace

double rotationBetween(const Motion& from, const Motion& to) noexcept {
  const double step_rad = to.angle_rad - from.angle_rad;
  // Fast path: std::remainder costs 20 ns.
  if (std::abs(step_rad) <= std::numbers::pi) return step_rad;
  return std::remainder(step_rad, 2.0 * std::numbers::pi);
}

double secondsBetween(MediaTime a, MediaTime b) noexcept {
  // In double: the difference of two 64-bit times may exceed 64 bits.
  return (static_cast<double>(b.time_since_epoch().count()) -
          static_cast<double>(a.time_since_epoch().count())) *
         1e-9;
}

Pose restingPose(const Motion& motion) noexcept {
  return {motion.position_mm, Vec3::Zero(), motion.acceleration_mm_s2, motion.angle_rad, 0.0};
}

Pose linearPose(const Motion& from, const Motion& to, double interval_s, double time_s) noexcept {
  const double s = time_s / interval_s;
  const Vec3 step_mm = to.position_mm - from.position_mm;
  const double step_rad = rotationBetween(from, to);
  return {from.position_mm + s * step_mm, step_mm / interval_s,
          (1.0 - s) * from.acceleration_mm_s2 + s * to.acceleration_mm_s2,
          from.angle_rad + s * step_rad, step_rad / interval_s};
}

Vec3 VelocityJumps::displacement(double time_s) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    sum += at[i].delta_mm_s * std::max(0.0, time_s - at[i].time_s);
  }
  return sum;
}

Vec3 VelocityJumps::velocity(double time_s) const noexcept {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    if (time_s >= at[i].time_s) sum += at[i].delta_mm_s;
  }
  return sum;
}

HermitePath::HermitePath(const PlayObject& from, const PlayObject& to, MediaTime from_time,
                         double interval_s) noexcept
    : acceleration_mm_s2_(from.motion.acceleration_mm_s2),
      acceleration_change_mm_s2_(to.motion.acceleration_mm_s2 - from.motion.acceleration_mm_s2),
      interval_s_(interval_s),
      rate_1_s_(1.0 / interval_s) {
  const Motion& a = from.motion;
  const Motion& b = to.motion;
  // The later frame describes the interval best; both frames may list the impact.
  kinks_ = findKinks(to, from_time, interval_s);
  if (kinks_.count == 0) kinks_ = findKinks(from, from_time, interval_s);
  kinks_ = plausible(kinks_, b.velocity_mm_s - a.velocity_mm_s);

  path_ = {a.position_mm, a.velocity_mm_s, b.position_mm - kinks_.displacement(interval_s),
           b.velocity_mm_s - kinks_.velocity(interval_s)};
  const double step_mm = (path_.p1 - path_.p0).norm();
  path_.v0 *= shortening(path_.v0.norm() * interval_s, step_mm, kPlausible_mm);
  path_.v1 *= shortening(path_.v1.norm() * interval_s, step_mm, kPlausible_mm);

  const double step_rad = rotationBetween(a, b);
  angle_ = {a.angle_rad, a.angular_velocity_rad_s, a.angle_rad + step_rad,
            b.angular_velocity_rad_s};
  angle_.v0 *= shortening(std::abs(angle_.v0) * interval_s, std::abs(step_rad), kPlausible_rad);
  angle_.v1 *= shortening(std::abs(angle_.v1) * interval_s, std::abs(step_rad), kPlausible_rad);
  turns_ = step_rad != 0.0 || angle_.v0 != 0.0 || angle_.v1 != 0.0;
}

Pose HermitePath::at(double time_s) const noexcept {
  const double s = time_s * rate_1_s_;
  const double r = 1.0 - s;
  const double bend = 6.0 * s * r * rate_1_s_;
  const auto value = [&]<class T>(const Ends<T>& of) -> T {
    return (1.0 + 2.0 * s) * r * r * of.p0 + interval_s_ * s * r * r * of.v0 +
           s * s * (3.0 - 2.0 * s) * of.p1 - interval_s_ * s * s * r * of.v1;
  };
  const auto rate = [&]<class T>(const Ends<T>& of) -> T {
    return bend * (of.p1 - of.p0) + r * (1.0 - 3.0 * s) * of.v0 + s * (3.0 * s - 2.0) * of.v1;
  };
  Pose pose;
  pose.position_mm = value(path_);
  pose.velocity_mm_s = rate(path_);
  if (kinks_.count > 0) {
    pose.position_mm += kinks_.displacement(time_s);
    pose.velocity_mm_s += kinks_.velocity(time_s);
  }
  pose.acceleration_mm_s2 = acceleration_mm_s2_ + s * acceleration_change_mm_s2_;
  pose.angle_rad = turns_ ? value(angle_) : angle_.p0;
  pose.angular_velocity_rad_s = turns_ ? rate(angle_) : 0.0;
  return pose;
}

Pose deadReckonedPose(const PlayObject& from, MediaTime from_time, double limit_s,
                      double time_s) noexcept {
  Pose pose = restingPose(from.motion);
  const double carried_s = std::min(time_s, limit_s);
  const VelocityJumps kinks = findKinks(from, from_time, limit_s);
  pose.position_mm += from.motion.velocity_mm_s * carried_s + kinks.displacement(carried_s);
  pose.angle_rad += from.motion.angular_velocity_rad_s * carried_s;
  if (time_s >= limit_s) {
    pose.acceleration_mm_s2.setZero();
    return pose;
  }
  pose.velocity_mm_s = from.motion.velocity_mm_s + kinks.velocity(carried_s);
  pose.angular_velocity_rad_s = from.motion.angular_velocity_rad_s;
  pose.acceleration_mm_s2 *= 1.0 - time_s / limit_s;
  return pose;
}

}  // namespace hapticast::client
