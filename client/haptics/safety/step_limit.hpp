// SPDX-License-Identifier: MIT
// Slew limit with motion allowance. It splits a step of the force into the part that the hand's own
// motion explains and the rest. It limits the rest and meters the excess.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

inline constexpr double kDamperSpeed_mm_s =
    300.0;  ///< limit of the speed inside the damper; chosen

/// State of a tick for the limit, device frame.
struct StepState {
  Vec3 force_N = Vec3::Zero();
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  HipState ahead;  ///< predicted HIP, where the wall acts
  // Zero without contact:
  bool contact = false;
  double local_stiffness_N_mm = 0.0;  ///< along the normal
  double damping_Ns_m = 0.0;          ///< along the normal
  double most_damper_N = 0.0;         ///< limit of the damper in this tick
  Vec3 normal = Vec3::Zero();
  double depth_mm = 0.0;  ///< along the normal
};

/// Part of a step of the force that the hand's motion explains.
struct MotionExplainedStep {
  Vec3 damper_N = Vec3::Zero();  ///< this vector or a part of it, along the normal
  double spring_N = 0.0;         ///< in any direction, because a relief is curved
};
/// Returns the part of the step from `last` to `now` that the hand explains.
///
/// It uses the counted motion of the HIP and the wall *before* this tick, not the force: K|dx| in
/// any direction, and B dv along the normal. Where the HIP itself enters (the depth is at most its
/// motion inwards), it uses K depth, and B v up to the damper's limit. The speed is limited like
/// that of the damper.
///
/// Changes of stiffness, surface or contact by the stream explain nothing. Nor does a predicted
/// motion: if it does not occur, a stream would cause the steps.
MotionExplainedStep stepAllowedByMotion(const StepState& now, const StepState& last) noexcept;

/// Limit of the step of the force in a tick: the part that the hand explains, plus the profile's
/// slew. The functions use only the force before and after.
class StepLimit {
 public:
  explicit StepLimit(const DeviceProfile& profile) noexcept;
  /// Returns the excess of the step over the limit, N: 0 within it, infinity for a force that is
  /// not finite.
  [[nodiscard]] double excess_N(const Vec3& force_N, const Vec3& last_N,
                                const MotionExplainedStep& hand) const noexcept;
  /// Returns the force that a too large step may reach in this tick. Requires excess_N() > 0. Only
  /// the unexplained part is limited: a plain slew limit pumps energy into the hand.
  [[nodiscard]] Vec3 limited(const Vec3& force_N, const Vec3& last_N,
                             const MotionExplainedStep& hand) const noexcept;

 private:
  struct Step {
    Vec3 explained_N;
    Vec3 rest_N;
    double allowed_N;  // limit of rest_N
  };
  [[nodiscard]] Step computeStep(const Vec3& force_N, const Vec3& last_N,
                                 const MotionExplainedStep& hand) const noexcept;

  double rise_N_, fall_N_, peak_N_;
};

}  // namespace hapticast::client
