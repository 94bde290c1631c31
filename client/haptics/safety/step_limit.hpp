// SPDX-License-Identifier: MIT
// Steps of the force: what the hand's own motion explains of one, a limit for the rest, and a meter
// behind all of it. Real-time room.
#pragma once

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

inline constexpr double kDamperSpeed_mm_s =
    300.0;  ///< limit of the speed inside the damper; chosen

/// What the limit has to know of a tick.
struct StepState {
  Vec3 force_N = Vec3::Zero();
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  HipState ahead;  ///< where the wall is touched
  // Without contact: zero.
  bool contact = false;
  double local_stiffness_N_mm = 0.0;  ///< along the normal
  double damping_Ns_m = 0.0;          ///< along the normal
  double most_damper_N = 0.0;         ///< what the damper may add in this tick
  Vec3 normal = Vec3::Zero();
  double depth_mm = 0.0;  ///< along the normal
};

/// What the hand's own motion explains of a step of the force.
struct MotionExplainedStep {
  Vec3 damper_N = Vec3::Zero();  ///< this vector or a part of it: the damper acts along the normal
  double spring_N = 0.0;         ///< this much in any direction: a relief is curved
};
/// Knows the tip's motion by its counts and the wall it touched *before* this tick, not the force:
/// K|dx| in any direction, B dv along the normal, and where the tip itself enters (the depth is at
/// most its way inwards) K depth and B v up to what the damper may add there; velocities no larger
/// than the damper's limit. What the stream does to stiffness, surface or contact in this tick
/// explains nothing, and a motion that is only foreseen explains nothing either: where it does not
/// happen a stream would make the steps.
MotionExplainedStep stepAllowedByMotion(const StepState& now, const StepState& last) noexcept;

/// The step of the force that a device's user may feel in a tick: what the hand explains and the
/// profile's slew more. Both functions know only the force before and after, not how it was made.
class StepLimit {
 public:
  explicit StepLimit(const DeviceProfile& profile) noexcept;
  /// How far the force exceeds the limit; infinite when it is not finite.
  [[nodiscard]] double excess_N(const Vec3& force_N, const Vec3& last_N,
                                const MotionExplainedStep& hand) const noexcept;
  /// What of a force that exceeds the limit may be reached in this tick. Only what the hand does
  /// not explain is limited: a plain slew limit pumps energy into the hand.
  [[nodiscard]] Vec3 limited(const Vec3& force_N, const Vec3& last_N,
                             const MotionExplainedStep& hand) const noexcept;

 private:
  struct Step {
    Vec3 explained_N;
    Vec3 rest_N;
    double allowed_N;  // of the rest
  };
  [[nodiscard]] Step computeStep(const Vec3& force_N, const Vec3& last_N,
                                 const MotionExplainedStep& hand) const noexcept;

  double rise_N_, fall_N_, peak_N_;
};

}  // namespace hapticast::client
