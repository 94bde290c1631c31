// SPDX-License-Identifier: MIT
// Step 1 of the safety chain: checks geometry and material of a tick, limits the surface velocity,
// and detects jumps.
// Thread: loop, real-time.
#include <algorithm>
#include <cmath>

#include "client/haptics/safety/chain.hpp"

namespace hapticast::client {

namespace {
constexpr double kSurfaceSpeed_mm_s = 1500.0;  // plausible limit
constexpr double kJump_mm = 3.0;               // unexplained change of depth in a tick
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

SafetyChain::Geometry SafetyChain::plausible(const SafetyInput& in,
                                             SafetyOutput& out) const noexcept {
  const bool all_finite = finite(in);
  out.too_far = all_finite && in.displacement_mm.squaredNorm() > kFarthest_mm * kFarthest_mm;
  if (!all_finite || out.too_far) {
    out.not_finite = true;
    out.interferences |= bit(SafetyAction::kNotFinite);
    return heldGeometry(in.ahead.position_mm);
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
    out.interferences |= bit(SafetyAction::kSurfaceSpeed);
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
void SafetyChain::material(const SafetyInput& in, Geometry& geometry,
                           SafetyOutput& out) const noexcept {
  geometry.stiffness_factor = std::max(1.0, in.stiffness_factor);
  const double limit_N_mm = stiffness_limit_N_mm_ / geometry.stiffness_factor;
  geometry.stiffness_N_mm = std::max(0.0, in.stiffness_N_mm);
  if (links_.stiffness_limit && geometry.stiffness_N_mm > limit_N_mm) {
    geometry.stiffness_N_mm = limit_N_mm;
    out.interferences |= bit(SafetyAction::kStiffness);
  }
  if (!links_.damping) return;
  const double law_Ns_m = wallDamping_Ns_m(geometry.stiffness_N_mm * geometry.stiffness_factor,
                                           mass_kg_, stiffness_limit_N_mm_);
  const double most_Ns_m = std::max(0.0, damping_limit_Ns_m_ - law_Ns_m);
  if (in.damping_Ns_m > most_Ns_m) out.interferences |= bit(SafetyAction::kDamping);
  geometry.damping_Ns_m = law_Ns_m + std::clamp(in.damping_Ns_m, 0.0, most_Ns_m);
}

/// Returns the last geometry as a plane at rest; only the HIP moves.
SafetyChain::Geometry SafetyChain::heldGeometry(const Vec3& ahead_mm) const noexcept {
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
  if (change_mm <= kJump_mm) return false;
  const double moved_mm = (in.ahead.position_mm - last_.ahead.position_mm).norm();
  return change_mm > kJump_mm + (1.0 + geometry.stiffness_factor) * moved_mm;
}

}  // namespace hapticast::client
