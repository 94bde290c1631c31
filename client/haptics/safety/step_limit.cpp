// SPDX-License-Identifier: MIT
#include "client/haptics/safety/step_limit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
/// Returns the point nearest to `point` on the segment from the origin to `end`.
Vec3 findNearestOnWay(const Vec3& end, const Vec3& point) noexcept {
  const double along = point.dot(end);
  if (!(along > 0.0)) return Vec3::Zero();
  const double square = end.squaredNorm();
  return along < square ? Vec3(along / square * end) : end;
}
}  // namespace

void CountedMotion::add(const Vec3& position_mm, bool jumped) noexcept {
  newest_ = (newest_ + 1) % kKept;
  position_mm_.col(newest_) = position_mm;
  if (jumped) position_mm_.colwise() = position_mm;
}

double CountedMotion::step_mm() const noexcept {
  return std::min((ago(0) - ago(1)).norm(), (ago(0) - ago(4)).norm() / 4.0);
}

Vec3 CountedMotion::change_mm_s() const noexcept {
  const Vec3 bend_mm = ago(0) - 2.0 * ago(2) + ago(4);
  const double size_mm = bend_mm.norm();
  if (size_mm <= count_mm_) return Vec3::Zero();
  return bend_mm * ((size_mm - count_mm_) / (size_mm * 4.0 * kTick_s));
}

namespace {
/// Returns true if the stream moved the surface over the HIP: the hand did not enter it.
bool isCovered(const StepState& now, const StepState& last) noexcept {
  const double inwards_mm = -(now.ahead.position_mm - last.ahead.position_mm).dot(now.normal);
  return !last.contact && now.depth_mm > inwards_mm;
}

/// Returns the change of the damper's force for a change of the HIP's velocity along the normal.
/// The speed of the damper goes at most from one end of its range to the other.
double damperStep_N(const StepState& wall, const Vec3& change_mm_s, double most_mm_s) noexcept {
  return wall.damping_Ns_m * 1e-3 *
         std::clamp(-change_mm_s.dot(wall.normal), -most_mm_s, most_mm_s);
}
}  // namespace

MotionExplainedStep computeStepAllowedByMotion(const StepState& now,
                                               const StepState& last) noexcept {
  if (!now.contact && !last.contact) return {};
  if (isCovered(now, last)) return {};
  const StepState& wall = last.contact ? last : now;
  if (!last.contact) {
    return {Vec3::Zero(), wall.local_stiffness_N_mm * std::min(now.depth_mm, now.moved_mm)};
  }
  return {damperStep_N(wall, now.velocity_change_mm_s, 2.0 * kDamperSpeed_mm_s) * wall.normal,
          wall.local_stiffness_N_mm * now.moved_mm};
}

MotionExplainedStep computeStepPossibleByHand(const StepState& now,
                                              const StepState& last) noexcept {
  if (!now.contact && !last.contact) return {};
  if (isCovered(now, last)) return {};
  const StepState& wall = last.contact ? last : now;
  const double path_mm = (now.position_mm - last.position_mm).norm();
  if (!last.contact) {
    const double damper_N = damperStep_N(wall, now.velocity_mm_s, kDamperSpeed_mm_s);
    return {std::min(damper_N, now.most_damper_N) * wall.normal,
            wall.local_stiffness_N_mm * std::min(now.depth_mm, path_mm)};
  }
  const Vec3 change_mm_s = now.velocity_mm_s - last.velocity_mm_s;
  return {damperStep_N(wall, change_mm_s, 2.0 * kDamperSpeed_mm_s) * wall.normal,
          wall.local_stiffness_N_mm * path_mm};
}

StepLimit::StepLimit(const DeviceProfile& profile) noexcept
    : rise_N_(profile.slew_rise_N_per_tick),
      fall_N_(profile.slew_fall_N_per_tick),
      peak_N_(profile.peak_N) {}

StepLimit::Step StepLimit::computeStep(const Vec3& force_N, const Vec3& last_N,
                                       const MotionExplainedStep& hand) const noexcept {
  const Vec3 step_N = force_N - last_N;
  const Vec3 explained_N = findNearestOnWay(hand.damper_N, step_N);
  const bool rises = force_N.squaredNorm() > (last_N + explained_N).squaredNorm();
  return {explained_N, step_N - explained_N, (rises ? rise_N_ : fall_N_) + hand.spring_N};
}

double StepLimit::excess_N(const Vec3& force_N, const Vec3& last_N,
                           const MotionExplainedStep& hand) const noexcept {
  const Step step = computeStep(force_N, last_N, hand);
  constexpr double kRounding_N = 1e-9;
  const double most_N = step.allowed_N + kRounding_N;
  if (step.rest_N.squaredNorm() <= most_N * most_N) return 0.0;
  const double rest_N = step.rest_N.norm();
  // NaN must not count as a step of zero.
  return std::isfinite(rest_N) ? rest_N - step.allowed_N : std::numeric_limits<double>::infinity();
}

Vec3 StepLimit::limitForce(const Vec3& force_N, const Vec3& last_N,
                           const MotionExplainedStep& hand) const noexcept {
  const Step step = computeStep(force_N, last_N, hand);
  Vec3 reached_N = last_N + step.explained_N + step.rest_N * (step.allowed_N / step.rest_N.norm());
  if (reached_N.norm() <= peak_N_) return reached_N;
  // The limited step exceeds the peak. A step straight to the force does not.
  const Vec3 straight_N = force_N - last_N;
  return last_N + straight_N * std::min(1.0, std::min(rise_N_, fall_N_) / straight_N.norm());
}

}  // namespace hapticast::client
