// SPDX-License-Identifier: MIT
#include "client/haptics/safety/chain.hpp"

#include <algorithm>
#include <cmath>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
/// Returns the energy (mJ) of a spring whose force saturates at limit_N.
double springEnergy_mJ(double stiffness_N_mm, double depth_mm, double limit_N) noexcept {
  const double force_N = stiffness_N_mm * depth_mm;
  return force_N <= limit_N ? 0.5 * force_N * depth_mm
                            : limit_N * (depth_mm - 0.5 * limit_N / stiffness_N_mm);
}

/// Returns the depth of the counted position in the present surface. The wall acts at the predicted
/// position in the surface of that time.
double countedDepth_mm(const StepState& state) noexcept {
  const Vec3 since_mm = state.position_mm - state.ahead.position_mm + state.surface_ahead_mm;
  return std::max(0.0, state.depth_mm - since_mm.dot(state.normal));
}
}  // namespace

SafetyChain::SafetyChain(const DeviceProfile& profile, const SafetyLinks& links) noexcept
    : links_(links),
      peak_N_(profile.peak_N),
      mass_kg_(profile.mass_kg),
      profile_delay_ticks_(profile.delay_ticks),
      wall_N_mm_(profile.stiffness_N_mm),
      limit_N_(profile.peak_N),
      steps_(profile),
      moved_(profile.count_mm),
      ports_(profile.delay_ticks, profile.count_mm),
      fade_(profile.residue_N_per_tick, links.fade, links.arming),
      tank_(profile),
      thermal_(profile),
      watch_(profile.count_mm),
      bounces_(profile.mass_kg) {
  setDelay(profile.delay_ticks);
}

void SafetyChain::setDelay(int delay_ticks) noexcept {
  delay_ticks_ = delay_ticks;
  stiffness_limit_N_mm_ = stiffnessLimit_N_mm(mass_kg_, delay_ticks);
  damping_limit_Ns_m_ = dampingLimit_Ns_m(mass_kg_, delay_ticks);
  ports_.setDelay(delay_ticks);
}

void SafetyChain::forgetDelay() noexcept {
  forget_delay_ = false;
  setDelay(profile_delay_ticks_);
}

// The numbers are the steps of client/haptics/safety/README.md. The fade (9) acts before the
// tank (5), the budget (6) and the slew limit (8). A fade at its begin or end, a release ramp and a
// gain can step as well. Only limits behind all of them hold for the sent force.
SafetyOutput SafetyChain::step(const SafetyInput& in) noexcept {
  SafetyOutput out;
  if (forget_delay_ && !in.contact && !acts()) forgetDelay();
  account_.refill();
  limit_N_ = links_.thermal ? thermal_.limit_N() : peak_N_;  // 6
  const Geometry geometry = plausible(in, out);              // 1
  const bool halt_now = halts(in, out);
  const bool touchable = in.in_contact && !out.not_finite && halt_ == Halt::kNone;
  // A scene that disappears in contact leaves no force to fade: the last force ramps down.
  const bool vanished = !in.in_contact && geometry_.contact && !geometry.contact;
  const bool jump = halt_now || vanished || jumped(in, geometry);
  const bool scene_jumped = in.scene_jumped && acts();
  damper_.step(geometry.contact);
  StepState now = computeState(in, geometry, out.not_finite);
  meter(in, now, geometry, jump, out);  // 5, 10

  out.static_force_N = wallForce(now, geometry, out);                          // 3, 5
  out.dynamic_force_N = dynamicForce(in, geometry, out);                       // 4
  limitForce(in, {.jump = jump, .touchable = touchable}, now, geometry, out);  // 7, 9, 5, 8

  ports_.sent(now.force_N, now.force_N - static_N_);
  thermal_.add(now.force_N.squaredNorm());
  out.force_N = now.force_N;
  out.contact = geometry.contact;
  out.penetration_mm = geometry.size_mm;
  last_ = now;
  geometry_ = geometry;
  if (geometry.contact) wall_N_mm_ = now.local_stiffness_N_mm;
  countTrust(out.safety_actions, scene_jumped);
  return out;
}

/// Sets now.force_N to the sum of both forces after clamp, fade, tank and slew limit.
void SafetyChain::limitForce(const SafetyInput& in, FadeTick tick, StepState& now,
                             const Geometry& geometry, SafetyOutput& out) noexcept {
  const Vec3 sum_N = out.static_force_N + out.dynamic_force_N;
  const Vec3 own_N = out.static_force_N + inertia_N_ * dynamic_fade_;
  const double clamp = clampFactor(sum_N, out);  // 7
  tick.full_N = clamp * sum_N;
  tick.full_static_N = clamp * own_N;
  fadeAndArm(in, tick, now, geometry, out);  // 9
  const double gain = clamp * fade_.gain();
  const Vec3 faded_N = sum_N * gain + fade_.residue_N();
  const double tank = tankFactor(faded_N, out);  // 5
  const double again = clampFactor(faded_N * tank, out);
  now.force_N = faded_N * tank * again;
  const Vec3 faded_own_N = own_N * gain + fade_.residueStatic_N();
  static_N_ = limitStep(now, faded_own_N * (tank * again), in.measurement_jumped, out);  // 8
}

/// A hand in a stiff wall causes slowed steps as well: only those of the stream cost trust.
void SafetyChain::countTrust(std::uint32_t safety_actions, bool scene_jumped) noexcept {
  if (!stream_stepped_) safety_actions &= ~bit(SafetyAction::kSlew);
  trust_.add(safety_actions, scene_jumped);
  const bool pushed = geometry_.contact && acts();
  trust_.addMotion(pushed ? geometry_.surface_velocity_mm_s.dot(geometry_.normal) : 0.0,
                   pushed ? last_.velocity_mm_s.dot(geometry_.normal) : 0.0);
}

/// Determines the cause of a halt. Returns true if the halt begins in this tick.
bool SafetyChain::halts(const SafetyInput& in, SafetyOutput& out) noexcept {
  if (halt_ != Halt::kNone) {
    if (stop_requested_) halt_ = Halt::kStopped;
    return false;
  }
  const bool distrusts = links_.trust && trust_.lost();
  halt_ = stop_requested_  ? Halt::kStopped
          : distrusts      ? Halt::kTrustLost
          : in.device_lost ? Halt::kDeviceLost
                           : Halt::kNone;
  out.trust_lost = halt_ == Halt::kTrustLost;
  return halt_ != Halt::kNone;
}

/// Applies the slew limit to now.force_N. Returns the share of wall and inertia in it: that share
/// steps as far as it could step alone, and the object's share absorbs the rest of the limit.
Vec3 SafetyChain::limitStep(StepState& now, const Vec3& static_N, bool measurement_jumped,
                            SafetyOutput& out) noexcept {
  const MotionExplainedStep possible =
      measurement_jumped ? MotionExplainedStep{} : computeStepPossibleByHand(now, last_);
  // Compares what the chain wants in both ticks: a force behind its target catches up afterwards.
  const bool by_stream =
      !measurement_jumped && steps_.excess_N(now.force_N, wanted_N_, possible) > 0.0;
  wanted_N_ = now.force_N;
  const MotionExplainedStep hand =
      measurement_jumped ? MotionExplainedStep{} : computeStepAllowedByMotion(now, last_);
  out.step_excess_N = steps_.excess_N(now.force_N, last_.force_N, hand);
  const bool slowed = out.step_excess_N > 0.0 && links_.slew;
  stream_stepped_ = slowed && by_stream;
  if (!slowed) return static_N;
  now.force_N = steps_.limitForce(now.force_N, last_.force_N, hand);
  out.step_excess_N = steps_.excess_N(now.force_N, last_.force_N, hand);
  out.safety_actions |= bit(SafetyAction::kSlew);
  return steps_.excess_N(static_N, static_N_, hand) > 0.0
             ? steps_.limitForce(static_N, static_N_, hand)
             : static_N;
}

StepState SafetyChain::computeState(const SafetyInput& in, const Geometry& geometry,
                                    bool not_finite) noexcept {
  StepState now{.position_mm = in.position_mm,
                .velocity_mm_s = in.velocity_mm_s,
                .ahead = in.ahead,
                .contact = geometry.contact};
  if (not_finite &&
      !(in.position_mm + in.velocity_mm_s + in.ahead.position_mm + in.ahead.velocity_mm_s)
           .allFinite()) {
    now.position_mm = last_.position_mm;
    now.velocity_mm_s = last_.velocity_mm_s;
    now.ahead = last_.ahead;
  }
  moved_.add(now.position_mm, in.measurement_jumped);
  now.moved_mm = moved_.step_mm();
  now.velocity_change_mm_s = moved_.change_mm_s();
  if (!now.contact) return now;
  now.local_stiffness_N_mm = geometry.stiffness_N_mm * geometry.stiffness_factor;
  now.damping_Ns_m = geometry.damping_Ns_m;
  now.most_damper_N =
      damper_.most_N(geometry.stiffness_N_mm * geometry.displacement_mm.dot(geometry.normal));
  now.normal = geometry.normal;
  now.depth_mm = geometry.displacement_mm.dot(geometry.normal) / geometry.stiffness_factor;
  return now;
}

/// Feeds the energy meters and the oscillation detector with the tick that ended at this position.
void SafetyChain::meter(const SafetyInput& in, StepState& now, const Geometry& geometry, bool jump,
                        SafetyOutput& out) noexcept {
  surface_.add(geometry.surface_step_mm, delay_ticks_ + kPredictionMargin_ticks);
  now.surface_ahead_mm = surface_.coming_mm();
  PortTick tick{.position_mm = now.position_mm,
                .connected = !in.measurement_jumped || in.measurement_late,
                .surface_mm = surface_.present_mm()};
  const double gain = fade_.gain();
  // Each energy uses the stiffness of its own tick; with one tick in contact, both use that tick's
  // stiffness.
  const double stiffness_N_mm = (now.contact ? now : last_).local_stiffness_N_mm;
  const double before_N_mm = (last_.contact ? last_ : now).local_stiffness_N_mm;
  // At a jump the account of the discontinuities compares the springs.
  if (!jump) {
    tick.stored_mJ = gain * springEnergy_mJ(stiffness_N_mm, countedDepth_mm(now), limit_N_);
    tick.stored_before_mJ = gain * springEnergy_mJ(before_N_mm, countedDepth_mm(last_), limit_N_);
  }
  tank_.withdraw(ports_.meter(tick), now.velocity_mm_s);

  if (delay_ticks_ != profile_delay_ticks_ && geometry.contact) {
    out.safety_actions |= bit(SafetyAction::kLatency);
  }
  const Vec3& normal = now.contact ? geometry.normal : geometry_.normal;
  const double moved_mm =
      in.measurement_jumped ? 0.0 : normal.dot(now.position_mm - last_.position_mm);
  const bool swings = watch_.detectsAlarm(moved_mm, normal.dot(tick.surface_mm), acts() && !jump);
  const bool bounces =
      bounces_.detectsAlarm({now.velocity_mm_s, geometry.surface_velocity_mm_s, geometry.normal,
                             now.local_stiffness_N_mm, now.contact, acts(), jump},
                            delay_ticks_);
  const bool alarmed = swings || bounces;
  if (!alarmed || !links_.oscillation_detector || delay_ticks_ != profile_delay_ticks_) return;
  out.latency_alarm = true;
  if (delay_ticks_ < kMostDelay_ticks) setDelay(delay_ticks_ + 1);
}

/// F_s = K_r displacement + B u along the normal, never pulling. The passivity controller adds
/// damping for the energy that the contact has generated.
Vec3 SafetyChain::wallForce(const StepState& now, const Geometry& geometry,
                            SafetyOutput& out) const noexcept {
  if (!geometry.contact) return Vec3::Zero();
  const double u_mm_s =
      std::clamp((geometry.surface_velocity_mm_s - now.ahead.velocity_mm_s).dot(geometry.normal),
                 -kDamperSpeed_mm_s, kDamperSpeed_mm_s);
  const Vec3 spring_N = geometry.stiffness_N_mm * geometry.displacement_mm;
  // Only while the HIP leaves: against an approaching surface it would push the hand.
  const bool leaves = u_mm_s < 0.0;
  const double insurance_Ns_m = links_.passivity && leaves ? ports_.damping_Ns_m(u_mm_s) : 0.0;
  if (insurance_Ns_m > 0.0) out.safety_actions |= bit(SafetyAction::kPassivity);
  const double law_N = std::min(geometry.damping_Ns_m * u_mm_s * 1e-3, now.most_damper_N);
  const double damper_N = law_N + insurance_Ns_m * u_mm_s * 1e-3;
  const double pull_limit_N = -spring_N.dot(geometry.normal);
  if (damper_N < pull_limit_N) out.safety_actions |= bit(SafetyAction::kNoPull);
  return spring_N + std::max(damper_N, pull_limit_N) * geometry.normal;
}

Vec3 SafetyChain::dynamicForce(const SafetyInput& in, const Geometry& geometry,
                               SafetyOutput& out) noexcept {
  if (in.implausible) out.safety_actions |= bit(SafetyAction::kImplausible);
  const bool finite = in.dynamic_N.allFinite();
  if (!finite) {
    out.not_finite = true;
    out.safety_actions |= bit(SafetyAction::kNotFinite);
  }
  const bool valid = finite && in.dynamic_valid;
  if (valid) dynamic_N_ = in.dynamic_N;
  if (valid && in.inertia_N.allFinite()) inertia_N_ = in.inertia_N;
  dynamic_fade_ = std::clamp(dynamic_fade_ + (valid ? kFadeOut : -kFadeOut), 0.0, 1.0);
  if (!geometry.contact) dynamic_N_ = inertia_N_ = Vec3::Zero();
  return dynamic_N_ * dynamic_fade_;
}

void SafetyChain::fadeAndArm(const SafetyInput& in, FadeTick tick, const StepState& now,
                             const Geometry& geometry, SafetyOutput& out) noexcept {
  tick.contact = geometry.contact;
  tick.too_deep = geometry.size_mm > armDepth_mm(geometry.stiffness_N_mm, peak_N_);
  tick.spring_mJ = springEnergy_mJ(geometry.stiffness_N_mm, geometry.size_mm, limit_N_);
  if (in.measurement_late || in.measurement_jumped) {
    // The force was constant while the HIP moved by x: the spring gains K x² / 2.
    tick.gap_mJ =
        0.5 * now.local_stiffness_N_mm * (now.position_mm - last_.position_mm).squaredNorm();
  }
  tick.last_N = last_.force_N;
  tick.last_static_N = static_N_;
  out.safety_actions |= fade_.step(tick, account_);
}

double SafetyChain::clampFactor(const Vec3& force_N, SafetyOutput& out) const noexcept {
  const double square_N2 = force_N.squaredNorm();
  if (square_N2 <= limit_N_ * limit_N_) return 1.0;
  if (square_N2 > peak_N_ * peak_N_) out.safety_actions |= bit(SafetyAction::kPeak);
  if (limit_N_ < peak_N_) out.safety_actions |= bit(SafetyAction::kThermal);
  return limit_N_ / std::sqrt(square_N2);
}

double SafetyChain::tankFactor(const Vec3& force_N, SafetyOutput& out) const noexcept {
  if (!links_.tank) return 1.0;
  const double factor = tank_.factor(force_N);
  if (factor < 1.0) out.safety_actions |= bit(SafetyAction::kTank);
  return factor;
}

namespace {
constexpr double kSurfaceSpeed_mm_s = 1500.0;  // plausible limit
constexpr double kJump_mm = 3.0;               // unexplained change of depth in a tick
constexpr double kAppears_mm = 0.3;            // the same where the contact begins
constexpr double kLongestStep_s = 20e-3;       // a larger step of play time connects no two ticks
constexpr double kUnit = 1e-12;                // rounding error of a unit vector's square
constexpr double kFarthest_mm = 1000.0;        // beyond the reach of any device: a broken number

bool finite(const SafetyInput& in) noexcept {
  // The sum is finite if all terms are, except for terms too large to be plausible.
  const Vec3 vectors = in.position_mm + in.velocity_mm_s + in.ahead.position_mm +
                       in.ahead.velocity_mm_s + in.displacement_mm + in.normal +
                       in.surface_velocity_mm_s;
  const double numbers =
      in.scene_step_s + in.stiffness_factor + in.stiffness_N_mm + in.damping_Ns_m;
  return std::isfinite(vectors.sum() + numbers);
}
}  // namespace

SafetyChain::Geometry SafetyChain::plausible(const SafetyInput& in, SafetyOutput& out) noexcept {
  const bool all_finite = finite(in);
  out.too_far = all_finite && in.displacement_mm.squaredNorm() > kFarthest_mm * kFarthest_mm;
  if (!all_finite || out.too_far) {
    out.not_finite = true;
    out.safety_actions |= bit(SafetyAction::kNotFinite);
    return holdGeometry(in.ahead.position_mm);
  }
  Geometry geometry;
  const double depth_mm = in.displacement_mm.norm();
  if (!in.contact || depth_mm <= 0.0) return geometry;
  geometry.contact = true;
  geometry.displacement_mm = in.displacement_mm;
  geometry.size_mm = depth_mm;
  const double square = in.normal.squaredNorm();
  // A zero normal, or one into the surface: the direction of the displacement cannot pull.
  if (!(square > 0.0) || in.normal.dot(in.displacement_mm) <= 0.0) {
    geometry.normal = in.displacement_mm / depth_mm;
  } else {
    geometry.normal = std::abs(square - 1.0) < kUnit ? in.normal : in.normal.normalized();
  }
  geometry.surface_velocity_mm_s = in.surface_velocity_mm_s;
  const double speed2 = in.surface_velocity_mm_s.squaredNorm();
  if (speed2 > kSurfaceSpeed_mm_s * kSurfaceSpeed_mm_s) {
    geometry.surface_velocity_mm_s *= kSurfaceSpeed_mm_s / std::sqrt(speed2);
    out.safety_actions |= bit(SafetyAction::kSurfaceSpeed);
  }
  const Vec3& from_mm_s =
      geometry_.contact ? geometry_.surface_velocity_mm_s : geometry.surface_velocity_mm_s;
  geometry.surface_step_mm = 0.5 * (from_mm_s + geometry.surface_velocity_mm_s) *
                             std::clamp(in.scene_step_s, 0.0, kLongestStep_s);
  material(in, geometry, out);
  return geometry;
}

/// Limits stiffness and damping along the normal to the limits of the device. The factor of
/// `perturbed` reduces the stiffness limit, not the damping.
void SafetyChain::material(const SafetyInput& in, Geometry& geometry, SafetyOutput& out) noexcept {
  geometry.stiffness_factor = std::max(1.0, in.stiffness_factor);
  const double limit_N_mm = stiffness_limit_N_mm_ / geometry.stiffness_factor;
  geometry.stiffness_N_mm = std::max(0.0, in.stiffness_N_mm);
  if (links_.stiffness_limit && geometry.stiffness_N_mm > limit_N_mm) {
    geometry.stiffness_N_mm = limit_N_mm;
    out.safety_actions |= bit(SafetyAction::kStiffness);
  }
  geometry.stiffness_N_mm = payStiffening(in, geometry);
  if (!links_.damping) return;
  const double law_Ns_m = wallDamping_Ns_m(geometry.stiffness_N_mm * geometry.stiffness_factor,
                                           mass_kg_, stiffness_limit_N_mm_);
  const double most_Ns_m = std::max(0.0, damping_limit_Ns_m_ - law_Ns_m);
  if (in.damping_Ns_m > most_Ns_m) out.safety_actions |= bit(SafetyAction::kDamping);
  geometry.damping_Ns_m = law_Ns_m + std::clamp(in.damping_Ns_m, 0.0, most_Ns_m);
}

/// A stream that stiffens a pressed spring adds energy: the account pays for it. Returns the
/// stiffness that it can pay for.
double SafetyChain::payStiffening(const SafetyInput& in, const Geometry& geometry) noexcept {
  const double before_N_mm = geometry_.stiffness_N_mm;
  const double rise_N_mm = geometry.stiffness_N_mm - before_N_mm;
  const bool continues = geometry_.contact && !in.world_jumped && !in.measurement_jumped;
  if (!continues || rise_N_mm <= 0.0) return geometry.stiffness_N_mm;
  const double added_mJ =
      fade_.gain() * (springEnergy_mJ(geometry.stiffness_N_mm, geometry.size_mm, limit_N_) -
                      springEnergy_mJ(before_N_mm, geometry.size_mm, limit_N_));
  const double paid_mJ = account_.pay(added_mJ);
  return before_N_mm + rise_N_mm * (paid_mJ < added_mJ ? paid_mJ / added_mJ : 1.0);
}

/// Returns the last geometry as a plane at rest; only the HIP moves.
SafetyChain::Geometry SafetyChain::holdGeometry(const Vec3& ahead_mm) const noexcept {
  Geometry held = geometry_;
  held.surface_velocity_mm_s = held.surface_step_mm = Vec3::Zero();
  if (!held.contact || !ahead_mm.allFinite()) return held;
  const Vec3 direction = held.displacement_mm / held.size_mm;
  const double now_mm = held.size_mm - direction.dot(ahead_mm - last_.ahead.position_mm);
  if (now_mm <= 0.0) return {};
  held.displacement_mm = now_mm * direction;
  held.size_mm = now_mm;
  return held;
}

bool SafetyChain::jumped(const SafetyInput& in, const Geometry& geometry) const noexcept {
  if (in.world_jumped || in.measurement_jumped) return true;
  // Without contact the displacement is zero: a surface that vanishes jumps like one that appears.
  const double change_mm = std::abs(geometry.size_mm - geometry_.size_mm);
  const bool begins = geometry.contact && !geometry_.contact;
  const double most_mm = begins ? kAppears_mm + geometry.surface_step_mm.norm() : kJump_mm;
  if (change_mm <= most_mm) return false;
  const double moved_mm = (in.ahead.position_mm - last_.ahead.position_mm).norm();
  return change_mm > most_mm + (1.0 + geometry.stiffness_factor) * moved_mm;
}

}  // namespace hapticast::client
