// SPDX-License-Identifier: MIT
// Steps of the force: what the hand's own motion explains of one, a limit for the rest, and a meter
// behind all of it (stability notes, section 5.8). Real-time room.
#pragma once

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

inline constexpr double kDamperSpeed_mm_s = 300.0;  ///< limit of the speed inside the damper

/// What the meter and the slew limit have to know of a tick.
struct StepState {
  Vec3 force_N = Vec3::Zero();
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  // Without contact: zero.
  bool contact = false;
  double local_stiffness_N_mm = 0.0;  ///< along the normal
  double damping_Ns_m = 0.0;          ///< along the normal
  Vec3 normal = Vec3::Zero();
  double depth_mm = 0.0;  ///< along the normal
};

/// What the hand's own motion explains of a step of the force.
struct Explained {
  Vec3 damper_N = Vec3::Zero();  ///< this vector or a part of it: the damper acts along the normal
  double spring_N = 0.0;         ///< this much in any direction: a relief is curved
};
/// Knows the tip's motion and the wall it touched *before* this tick: what the stream does to
/// stiffness, surface or contact in this tick explains nothing.
Explained explainedByHand(const StepState& now, const StepState& last) noexcept;

/// Limits what the hand's own motion does not explain: a plain slew limit pumps energy into the
/// hand.
class SlewLimit {
 public:
  explicit SlewLimit(const DeviceProfile& profile) noexcept;
  /// now.force_N, or what of it may be reached from `last` in this tick.
  [[nodiscard]] Vec3 limited(const StepState& now, const StepState& last,
                             bool measurement_jumped) const noexcept;

 private:
  double rise_N_, fall_N_, peak_N_;
};

/// Measures the finished force: how far its step exceeds what the hand's own motion explains and S
/// more. The hand explains, in the wall it touched before the tick: K|dx| in any direction, B dv
/// along the normal (or a part of it), and where the tip itself enters (the depth is at most its
/// way inwards) K depth and B v; velocities no larger than the damper's limit. Knows nothing of how
/// the force was made. Must read 0 always; infinite when the force is not finite.
class StepMeter {
 public:
  explicit StepMeter(const DeviceProfile& profile) noexcept;
  double excess_N(const StepState& now, bool measurement_jumped) noexcept;

 private:
  double rise_N_, fall_N_;
  StepState last_;
};

}  // namespace hapticast::client
