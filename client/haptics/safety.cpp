// SPDX-License-Identifier: MIT
#include "client/haptics/safety.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/haptics/hip_motion.hpp"

namespace hapticast::client {

namespace {
constexpr double kBaseDamping_Ns_m = 1.0;      // B_0
constexpr double kDamperSpeed_mm_s = 300.0;    // limit of u inside the damper
constexpr double kSurfaceSpeed_mm_s = 1500.0;  // faster is not plausible
constexpr double kJump_mm = 3.0;               // change of depth in a tick that nothing explains
constexpr double kArmDepth_mm = 2.0;
constexpr double kFarthest_mm = 1000.0;  // a displacement beyond any device is a broken number
constexpr double kFadeIn = kTick_s / 0.2;
constexpr double kFadeOut = kTick_s / 0.1;
constexpr double kStiffest_N_mm = 10.0;

double smoothstep(double x) noexcept { return x * x * (3.0 - 2.0 * x); }

/// What the hand's own motion explains of a step of the force.
struct Explained {
  Vec3 damper_N = Vec3::Zero();  ///< this vector or a part of it: the damper acts along the normal
  double spring_N = 0.0;         ///< this much in any direction: a relief is curved
};

/// Knows the tip's motion and the wall it touched *before* this tick: what the stream does to
/// stiffness, surface or contact in this tick explains nothing.
Explained explainedByHand(const StepState& now, const StepState& last, double lead_s) noexcept {
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
  const double damping_Ns_mm = wallDamping_Ns_m(wall.local_stiffness_N_mm, lead_s) * 1e-3;
  return {damping_Ns_mm * damped_mm_s * wall.normal,
          wall.local_stiffness_N_mm * (entering ? now.depth_mm : moved_mm.norm())};
}

/// The point nearest to `point` on the way from the origin to `end`.
Vec3 nearestOnWay(const Vec3& end, const Vec3& point) noexcept {
  const double square = end.squaredNorm();
  return square > 0.0 ? Vec3(std::clamp(point.dot(end) / square, 0.0, 1.0) * end)
                      : Vec3(Vec3::Zero());
}

bool believable(const SafetyInput& in) noexcept {
  return in.position_mm.allFinite() && in.velocity_mm_s.allFinite() &&
         in.displacement_mm.allFinite() && in.normal.allFinite() &&
         in.surface_velocity_mm_s.allFinite() && std::isfinite(in.stiffness_factor) &&
         std::isfinite(in.stiffness_N_mm) && in.displacement_mm.norm() <= kFarthest_mm;
}
}  // namespace

double wallLead_s(int delay_ticks) noexcept {
  // For 4 ticks: the mean of its neighbours (not measured).
  constexpr std::array<double, 6> kLead_s = {1.2e-3, 2.4e-3, 3.9e-3, 5.3e-3, 6.65e-3, 8.0e-3};
  return kLead_s[static_cast<std::size_t>(std::clamp(delay_ticks, 0, 5))];
}

double stiffnessLimit_N_mm(const DeviceProfile& profile) noexcept {
  const double lead_s = wallLead_s(profile.delay_ticks);
  return std::min(kStiffest_N_mm, 0.65 * profile.mass_kg / (lead_s * lead_s) * 1e-3);
}

double wallDamping_Ns_m(double stiffness_N_mm, double lead_s) noexcept {
  return stiffness_N_mm * 1e3 * lead_s + kBaseDamping_Ns_m;
}

double armDepth_mm(double stiffness_N_mm, double peak_N) noexcept {
  return stiffness_N_mm > 0.0 ? std::max(kArmDepth_mm, peak_N / stiffness_N_mm) : kArmDepth_mm;
}

StepMeter::StepMeter(const DeviceProfile& profile) noexcept
    : rise_N_(profile.slew_rise_N_per_tick),
      fall_N_(profile.slew_fall_N_per_tick),
      lead_s_(wallLead_s(profile.delay_ticks)) {}

double StepMeter::excess_N(const StepState& now, bool measurement_jumped) noexcept {
  const Explained hand = measurement_jumped ? Explained{} : explainedByHand(now, last_, lead_s_);
  const Vec3 step_N = now.force_N - last_.force_N;
  const Vec3 explained_N = nearestOnWay(hand.damper_N, step_N);
  const bool rises = now.force_N.norm() > (last_.force_N + explained_N).norm();
  const double allowed_N = (rises ? rise_N_ : fall_N_) + hand.spring_N;
  const double rest_N = (step_N - explained_N).norm();
  last_ = now;
  constexpr double kRounding_N = 1e-9;
  if (rest_N <= allowed_N + kRounding_N) return 0.0;
  // A number that is none must not read as "no step".
  return std::isfinite(rest_N) ? rest_N - allowed_N : std::numeric_limits<double>::infinity();
}

SafetyChain::SafetyChain(const DeviceProfile& profile) noexcept
    : peak_N_(profile.peak_N),
      rise_N_(profile.slew_rise_N_per_tick),
      fall_N_(profile.slew_fall_N_per_tick),
      residue_step_N_(profile.residue_N_per_tick),
      lead_s_(wallLead_s(profile.delay_ticks)),
      stiffness_limit_N_mm_(stiffnessLimit_N_mm(profile)),
      meter_(profile) {}

// The numbers of the steps are those of the stability notes. The fade (9) acts on the force before
// the slew limit (8): a fade that begins or ends, a residue that joins and a gain that multiplies
// all of it can step as well, and only a limit behind all of them holds for the force that is sent.
// Energy meters and tank (5) and the continuous-force budget (6) belong between the sum of the
// forces and the clamp.
SafetyOutput SafetyChain::step(const SafetyInput& in) noexcept {
  SafetyOutput out;
  const Geometry geometry = plausible(in, out);  // 1
  const bool halt_now = (in.device_lost || stop_requested_) && !halted_;
  halted_ = halted_ || halt_now;
  const bool touchable = in.touchable && !out.not_finite && !halted_;
  // A world that disappears under the tip leaves nothing to fade: its last force ramps down.
  const bool vanished = !in.touchable && geometry_.contact && !geometry.contact;
  const bool jump = halt_now || vanished || jumped(in, geometry);

  out.static_force_N = wallForce(in, geometry, out);                             // 3
  out.dynamic_force_N = dynamicForce(in, geometry, out);                         // 4
  const Vec3 wanted_N = clamped(out.static_force_N + out.dynamic_force_N, out);  // 7
  fadeAndArm(jump, touchable, geometry, out);                                    // 9
  const Vec3 target_N = clamped(wanted_N * smoothstep(fade_) + residue_N_, out);

  StepState now{.position_mm = in.position_mm,
                .velocity_mm_s = in.velocity_mm_s,
                .contact = geometry.contact};
  if (!now.position_mm.allFinite() || !now.velocity_mm_s.allFinite()) {
    now.position_mm = last_.position_mm;
    now.velocity_mm_s = last_.velocity_mm_s;
  }
  if (now.contact) {
    now.local_stiffness_N_mm = geometry.stiffness_N_mm * geometry.stiffness_factor;
    now.normal = geometry.normal;
    now.depth_mm = geometry.displacement_mm.dot(geometry.normal) / geometry.stiffness_factor;
  }
  now.force_N = slewed(target_N, now, in.measurement_jumped, out);  // 8
  out.step_excess_N = meter_.excess_N(now, in.measurement_jumped);
  out.force_N = now.force_N;
  out.contact = geometry.contact;
  out.penetration_mm = geometry.displacement_mm.norm();
  last_ = now;
  geometry_ = geometry;
  return out;
}

void SafetyChain::rearm() noexcept {
  stop_requested_ = halted_ = false;
  fade_ = 0.0;
  check_depth_ = true;
}

SafetyChain::Geometry SafetyChain::plausible(const SafetyInput& in, SafetyOutput& out) noexcept {
  if (!believable(in)) {
    out.not_finite = true;
    out.interferences |= bit(Interference::kNotFinite);
    return heldGeometry(in.position_mm);
  }
  Geometry geometry;
  const double depth_mm = in.displacement_mm.norm();
  if (!in.contact || depth_mm <= 0.0) return geometry;
  geometry.contact = true;
  geometry.displacement_mm = in.displacement_mm;
  const double length = in.normal.norm();
  // A normal that is none, or that looks into the surface: along the displacement nothing can pull.
  geometry.normal = length > 0.0 && in.normal.dot(in.displacement_mm) > 0.0
                        ? Vec3(in.normal / length)
                        : Vec3(in.displacement_mm / depth_mm);
  geometry.surface_velocity_mm_s = in.surface_velocity_mm_s;
  const double speed_mm_s = in.surface_velocity_mm_s.norm();
  if (speed_mm_s > kSurfaceSpeed_mm_s) {
    geometry.surface_velocity_mm_s *= kSurfaceSpeed_mm_s / speed_mm_s;
    out.interferences |= bit(Interference::kSurfaceSpeed);
  }
  geometry.stiffness_factor = std::max(1.0, in.stiffness_factor);
  const double limit_N_mm = stiffness_limit_N_mm_ / geometry.stiffness_factor;
  if (in.stiffness_N_mm > limit_N_mm) out.interferences |= bit(Interference::kStiffness);
  geometry.stiffness_N_mm = std::clamp(in.stiffness_N_mm, 0.0, limit_N_mm);
  return geometry;
}

/// The last geometry standing still as a plane: the tip moves against it, the surface does not
/// move.
SafetyChain::Geometry SafetyChain::heldGeometry(const Vec3& position_mm) const noexcept {
  Geometry held = geometry_;
  held.surface_velocity_mm_s = Vec3::Zero();
  if (!held.contact || !position_mm.allFinite()) return held;
  const double depth_mm = held.displacement_mm.norm();
  const Vec3 direction = held.displacement_mm / depth_mm;
  const double now_mm = depth_mm - direction.dot(position_mm - last_.position_mm);
  if (now_mm <= 0.0) return {};
  held.displacement_mm = now_mm * direction;
  return held;
}

bool SafetyChain::jumped(const SafetyInput& in, const Geometry& geometry) const noexcept {
  if (in.world_jumped || in.measurement_jumped) return true;
  // Without contact the displacement is zero: a surface that vanishes jumps like one that appears.
  const double change_mm =
      std::abs(geometry.displacement_mm.norm() - geometry_.displacement_mm.norm());
  const double moved_mm = (in.position_mm - last_.position_mm).norm();
  return change_mm > kJump_mm + (1.0 + geometry.stiffness_factor) * moved_mm;
}

/// F_s = K_r displacement + (K_r tau + B_0) u along the normal, never pulling. Stiffness and
/// damping are those along the normal, so a displacement that `perturbed` exaggerates is not damped
/// less than it is stiff.
Vec3 SafetyChain::wallForce(const SafetyInput& in, const Geometry& geometry,
                            SafetyOutput& out) const noexcept {
  if (!geometry.contact) return Vec3::Zero();
  const Vec3 velocity_mm_s = in.velocity_mm_s.allFinite() ? in.velocity_mm_s : last_.velocity_mm_s;
  const double u_mm_s =
      std::clamp((geometry.surface_velocity_mm_s - velocity_mm_s).dot(geometry.normal),
                 -kDamperSpeed_mm_s, kDamperSpeed_mm_s);
  const Vec3 spring_N = geometry.stiffness_N_mm * geometry.displacement_mm;
  const double damping_Ns_m =
      wallDamping_Ns_m(geometry.stiffness_N_mm * geometry.stiffness_factor, lead_s_);
  const double damper_N = damping_Ns_m * u_mm_s * 1e-3;
  const double pull_limit_N = -spring_N.dot(geometry.normal);
  if (damper_N < pull_limit_N) out.interferences |= bit(Interference::kNoPull);
  return spring_N + std::max(damper_N, pull_limit_N) * geometry.normal;
}

Vec3 SafetyChain::dynamicForce(const SafetyInput& in, const Geometry& geometry,
                               SafetyOutput& out) noexcept {
  const bool finite = in.dynamic_N.allFinite();
  if (!finite) {
    out.not_finite = true;
    out.interferences |= bit(Interference::kNotFinite);
  }
  const bool valid = finite && in.dynamic_valid;
  if (valid) dynamic_N_ = in.dynamic_N;
  dynamic_fade_ = std::clamp(dynamic_fade_ + (valid ? kFadeOut : -kFadeOut), 0.0, 1.0);
  if (!geometry.contact) dynamic_N_ = Vec3::Zero();
  return dynamic_N_ * dynamic_fade_;
}

void SafetyChain::fadeAndArm(bool jump, bool touchable, const Geometry& geometry,
                             SafetyOutput& out) noexcept {
  if (jump) {
    residue_N_ = last_.force_N;
    fade_ = 0.0;
    check_depth_ = true;
    out.interferences |= bit(Interference::kJump);
  }
  if (touchable && check_depth_) {
    blocked_ = geometry.displacement_mm.norm() > armDepth_mm(geometry.stiffness_N_mm, peak_N_);
    check_depth_ = false;
  }
  if (touchable && !geometry.contact) blocked_ = false;
  const bool armed = touchable && !blocked_;
  fade_ = std::clamp(fade_ + (armed ? kFadeIn : -kFadeOut), 0.0, 1.0);
  if (!touchable && fade_ == 0.0) check_depth_ = true;

  const double residue_N = residue_N_.norm();
  residue_N_ *= residue_N > residue_step_N_ ? 1.0 - residue_step_N_ / residue_N : 0.0;
  if (residue_N_ != Vec3::Zero()) out.interferences |= bit(Interference::kResidue);
  if (geometry.contact && blocked_) out.interferences |= bit(Interference::kUnarmed);
  if (geometry.contact && fade_ < 1.0) out.interferences |= bit(Interference::kFade);
}

Vec3 SafetyChain::clamped(const Vec3& force_N, SafetyOutput& out) const noexcept {
  const double size_N = force_N.norm();
  if (size_N <= peak_N_) return force_N;
  out.interferences |= bit(Interference::kPeak);
  return force_N * (peak_N_ / size_N);
}

/// Limits only what the hand's own motion does not explain: a plain slew limit pumps energy into
/// the hand.
Vec3 SafetyChain::slewed(const Vec3& target_N, const StepState& now, bool measurement_jumped,
                         SafetyOutput& out) const noexcept {
  const Explained hand = measurement_jumped ? Explained{} : explainedByHand(now, last_, lead_s_);
  const Vec3 step_N = target_N - last_.force_N;
  const Vec3 explained_N = nearestOnWay(hand.damper_N, step_N);
  const Vec3 rest_N = step_N - explained_N;
  const bool rises = target_N.norm() > (last_.force_N + explained_N).norm();
  const double allowed_N = (rises ? rise_N_ : fall_N_) + hand.spring_N;
  const double size_N = rest_N.norm();
  if (size_N <= allowed_N) return target_N;
  out.interferences |= bit(Interference::kSlew);
  Vec3 force_N = last_.force_N + explained_N + rest_N * (allowed_N / size_N);
  if (force_N.norm() <= peak_N_) return force_N;
  // The way round would leave what the device can stand; the straight way does not.
  return last_.force_N + step_N * std::min(1.0, std::min(rise_N_, fall_N_) / step_N.norm());
}

}  // namespace hapticast::client
