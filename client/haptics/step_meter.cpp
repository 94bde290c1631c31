// SPDX-License-Identifier: MIT
#include "client/haptics/step_meter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticast::client {

namespace {
/// The point nearest to `point` on the way from the origin to `end`.
Vec3 nearestOnWay(const Vec3& end, const Vec3& point) noexcept {
  const double along = point.dot(end);
  if (!(along > 0.0)) return Vec3::Zero();
  const double square = end.squaredNorm();
  return along < square ? Vec3(along / square * end) : end;
}
}  // namespace

Explained explainedByHand(const StepState& now, const StepState& last) noexcept {
  if (!now.contact && !last.contact) return {};
  const StepState& wall = last.contact ? last : now;
  const Vec3 moved_mm = now.position_mm - last.position_mm;
  const double inwards_mm = -moved_mm.dot(wall.normal);
  const bool entering = !last.contact;
  if (entering && now.depth_mm > inwards_mm) return {};  // the surface came, not the hand
  const Vec3 change_mm_s = entering ? now.velocity_mm_s : now.velocity_mm_s - last.velocity_mm_s;
  // The damper's own limit: full speed when it begins, from one end to the other later.
  const double most_mm_s = entering ? kDamperSpeed_mm_s : 2.0 * kDamperSpeed_mm_s;
  const double damped_mm_s = std::clamp(-change_mm_s.dot(wall.normal), -most_mm_s, most_mm_s);
  return {wall.damping_Ns_m * 1e-3 * damped_mm_s * wall.normal,
          wall.local_stiffness_N_mm * (entering ? now.depth_mm : moved_mm.norm())};
}

SlewLimit::SlewLimit(const DeviceProfile& profile) noexcept
    : rise_N_(profile.slew_rise_N_per_tick),
      fall_N_(profile.slew_fall_N_per_tick),
      peak_N_(profile.peak_N) {}

Vec3 SlewLimit::limited(const StepState& now, const StepState& last,
                        bool measurement_jumped) const noexcept {
  const Explained hand = measurement_jumped ? Explained{} : explainedByHand(now, last);
  const Vec3 step_N = now.force_N - last.force_N;
  const Vec3 explained_N = nearestOnWay(hand.damper_N, step_N);
  const Vec3 rest_N = step_N - explained_N;
  const bool rises = now.force_N.squaredNorm() > (last.force_N + explained_N).squaredNorm();
  const double allowed_N = (rises ? rise_N_ : fall_N_) + hand.spring_N;
  if (rest_N.squaredNorm() <= allowed_N * allowed_N) return now.force_N;
  const double size_N = rest_N.norm();
  const Vec3 force_N = last.force_N + explained_N + rest_N * (allowed_N / size_N);
  if (force_N.norm() <= peak_N_) return force_N;
  // The way round would leave what the device can stand; the straight way does not.
  return last.force_N + step_N * std::min(1.0, std::min(rise_N_, fall_N_) / step_N.norm());
}

StepMeter::StepMeter(const DeviceProfile& profile) noexcept
    : rise_N_(profile.slew_rise_N_per_tick), fall_N_(profile.slew_fall_N_per_tick) {}

double StepMeter::excess_N(const StepState& now, bool measurement_jumped) noexcept {
  const Explained hand = measurement_jumped ? Explained{} : explainedByHand(now, last_);
  const Vec3 step_N = now.force_N - last_.force_N;
  const Vec3 explained_N = nearestOnWay(hand.damper_N, step_N);
  const bool rises = now.force_N.squaredNorm() > (last_.force_N + explained_N).squaredNorm();
  const double allowed_N = (rises ? rise_N_ : fall_N_) + hand.spring_N;
  const double rest_N2 = (step_N - explained_N).squaredNorm();
  last_ = now;
  constexpr double kRounding_N = 1e-9;
  if (rest_N2 <= (allowed_N + kRounding_N) * (allowed_N + kRounding_N)) return 0.0;
  const double rest_N = std::sqrt(rest_N2);
  // A number that is none must not read as "no step".
  return std::isfinite(rest_N) ? rest_N - allowed_N : std::numeric_limits<double>::infinity();
}

}  // namespace hapticast::client
