// SPDX-License-Identifier: MIT
#include "client/device/virtual/hand_script.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/haptics/estimation/hip_estimator.hpp"
#include "common/time.hpp"

namespace hapticast::client {

namespace {
constexpr double kSpeed_mm_s = 300.0;        // relative to the object
constexpr double kObjectSpeed_mm_s = 600.0;  // largest speed of a followed object
constexpr double kAcceleration_mm_s2 = 5000.0;
constexpr double kGain_per_s = 20.0;  // controller gain near the goal
constexpr double kWaitHeight_mm = 45.0;
constexpr double kHover_mm = 10.0;
constexpr double kPush_N = 1.0;
constexpr double kFollow_N = 0.5;
constexpr double kPushSpeed_mm_s = 40.0;
constexpr int kHold_ticks = 1500;
constexpr int kRest_ticks = 500;
constexpr double kSlideDepth_mm = 1.0;
constexpr double kSlideSpeed_mm_s = 20.0;
constexpr double kSlideReach_mm = 6.0;

}  // namespace

HandScript::HandScript(HandKind kind, const HandStiffness& stiffness,
                       std::vector<HandTarget> targets)
    : kind_(kind), stiffness_(stiffness), targets_(std::move(targets)) {}

Vec3 HandScript::next(const TickReport& report, const Vec3& start_mm) noexcept {
  if (!started_) {
    started_ = true;
    begin_ = report.time;
    target_mm_ = start_mm;
  }
  if (kind_ == HandKind::kFile) return fromFile(toSeconds(report.time - begin_));
  const Vec3 carried_mm_s = report.object_present
                                ? limitLength(report.object_velocity_mm_s, kObjectSpeed_mm_s)
                                : Vec3(Vec3::Zero());
  moveTowards(goal(report), carried_mm_s);
  return target_mm_;
}

Vec3 HandScript::goal(const TickReport& report) noexcept {
  if (!report.object_present) {
    enter(Phase::kApproach);
    // Straight up first: a sideways motion would drag the touched object.
    return {target_mm_.x(), target_mm_.y(), kWaitHeight_mm};
  }
  if (kind_ == HandKind::kPress) return pressGoal(report);
  if (kind_ == HandKind::kSlide) return slideGoal(report);
  return {report.object_centre_mm.x(), report.object_centre_mm.y(),
          report.object_centre_height_mm - computeDepth_mm(kFollow_N, report.mapping.scale)};
}

/// Returns the depth of the target below the surface. Surface and hand are springs in series.
double HandScript::computeDepth_mm(double force_N, double scale) const noexcept {
  return force_N * (1.0 / stiffness_.surface_N_mm + 1.0 / stiffness_.hand_N_mm) / scale;
}

void HandScript::enter(Phase phase) noexcept {
  phase_ = phase;
  phase_ticks_ = 0;
}

Vec3 HandScript::pressGoal(const TickReport& report) noexcept {
  const double deepest_mm = computeDepth_mm(kPush_N, report.mapping.scale);
  const Vec2& centre_mm = report.object_centre_mm;
  const double above_mm = target_mm_.z() - report.object_centre_height_mm;
  const double aside_mm = (target_mm_.head<2>() - centre_mm).norm();
  ++phase_ticks_;
  switch (phase_) {
    case Phase::kApproach:
      phase_depth_mm_ = -kHover_mm;
      if (phase_ticks_ > kRest_ticks && aside_mm < 2.0 && std::abs(above_mm - kHover_mm) < 2.0) {
        enter(Phase::kPush);
      }
      break;
    case Phase::kPush:
      phase_depth_mm_ = std::min(phase_depth_mm_ + kPushSpeed_mm_s * kTick_s, deepest_mm);
      if (phase_depth_mm_ >= deepest_mm) enter(Phase::kHold);
      break;
    case Phase::kHold:
      if (phase_ticks_ > kHold_ticks) enter(Phase::kRelease);
      break;
    case Phase::kRelease:
      phase_depth_mm_ = std::max(phase_depth_mm_ - kPushSpeed_mm_s * kTick_s, -kHover_mm);
      if (phase_depth_mm_ <= -kHover_mm) enter(Phase::kApproach);
      break;
  }
  return {centre_mm.x(), centre_mm.y(), report.object_centre_height_mm - phase_depth_mm_};
}

Vec3 HandScript::slideGoal(const TickReport& report) noexcept {
  slide_size_ = std::clamp(slide_size_ + (report.over_object ? 0.2 : -1.0) * kTick_s, 0.1, 1.0);
  const double reach_mm = kSlideReach_mm * slide_size_;
  // Both axes together reach at most 1.25 x reach x rate (frequencies 1 and 1.5, amplitudes 1 and
  // 0.5).
  slide_s_ += kTick_s * kSlideSpeed_mm_s / (1.25 * reach_mm);
  const Vec2 place_mm =
      report.object_centre_mm + reach_mm * Vec2(std::sin(slide_s_), 0.5 * std::sin(1.5 * slide_s_));
  const double force_N = stiffness_.surface_N_mm * kSlideDepth_mm * report.mapping.scale;
  const double height_mm =
      report.over_object ? report.height_at_hip_mm : report.object_centre_height_mm;
  return {place_mm.x(), place_mm.y(), height_mm - computeDepth_mm(force_N, report.mapping.scale)};
}

/// Moves towards the goal as fast as possible without overshoot, plus the velocity of the goal.
void HandScript::moveTowards(const Vec3& goal_mm, const Vec3& goal_velocity_mm_s) noexcept {
  const Vec3 path_mm = goal_mm - target_mm_;
  const double distance_mm = path_mm.norm();
  Vec3 wanted_mm_s = goal_velocity_mm_s;
  if (distance_mm > 0.0) {
    const double speed_mm_s = std::min(
        {kSpeed_mm_s, std::sqrt(kAcceleration_mm_s2 * distance_mm), kGain_per_s * distance_mm});
    wanted_mm_s += path_mm * (speed_mm_s / distance_mm);
  }
  velocity_mm_s_ += limitLength(wanted_mm_s - velocity_mm_s_, kAcceleration_mm_s2 * kTick_s);
  target_mm_ += velocity_mm_s_ * kTick_s;
}

Vec3 HandScript::fromFile(double t_s) noexcept {
  while (row_ + 1 < targets_.size() && targets_[row_ + 1].t_s <= t_s) ++row_;
  const HandTarget& from = targets_[row_];
  if (row_ + 1 == targets_.size() || t_s <= from.t_s) return from.position_mm;
  const HandTarget& to = targets_[row_ + 1];
  const double s = (t_s - from.t_s) / (to.t_s - from.t_s);
  return from.position_mm + s * (to.position_mm - from.position_mm);
}

}  // namespace hapticast::client
