// SPDX-License-Identifier: MIT
// Slew limit of the force with an allowance for the hand's motion. A step is the change of the
// force from one tick to the next. The hand's own motion explains a part of each step, and that
// part is free. The slew limit bounds the rest.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

inline constexpr double kDamperSpeed_mm_s =
    300.0;  ///< the wall's damper uses at most this speed; the value is a choice

/// Bounds the motion of the HIP by the measured positions of the last ticks. The slew limit must
/// not use the filtered velocity, because a single encoder count changes that velocity by 56 mm/s.
class CountedMotion {
 public:
  /// `count_mm` is the size of an encoder count.
  explicit CountedMotion(double count_mm) noexcept : count_mm_(count_mm) {}
  /// Adds the position that this tick measured. If `jumped` is true, it does not continue the last
  /// position, and the HIP counts as resting.
  void add(const Vec3& position_mm, bool jumped) noexcept;
  /// Returns the motion of the HIP in this tick, mm. It is the smaller of two values: the measured
  /// motion of this tick, and the mean of the last four ticks.
  [[nodiscard]] double step_mm() const noexcept;
  /// Returns the change of the HIP's velocity in this tick, mm/s: the second difference over two
  /// intervals of two ticks, less one count.
  [[nodiscard]] Vec3 change_mm_s() const noexcept;

 private:
  static constexpr int kKept = 5;
  [[nodiscard]] Vec3 ago(int ticks) const noexcept {
    return position_mm_.col((newest_ + kKept - ticks) % kKept);
  }
  double count_mm_;
  Eigen::Matrix<double, 3, kKept> position_mm_ = Eigen::Matrix<double, 3, kKept>::Zero();
  int newest_ = 0;
};

/// State of one tick that the limit needs. All vectors are in the device frame.
struct StepState {
  Vec3 force_N = Vec3::Zero();
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  double moved_mm = 0.0;                     ///< motion in this tick (CountedMotion)
  Vec3 velocity_change_mm_s = Vec3::Zero();  ///< change in this tick (CountedMotion)
  HipState ahead;                            ///< predicted HIP; the wall acts there
  /// Motion of the surface from now to the time of `ahead`.
  Vec3 surface_ahead_mm = Vec3::Zero();
  // These are zero without a contact:
  bool contact = false;
  double local_stiffness_N_mm = 0.0;  ///< along the normal
  double damping_Ns_m = 0.0;          ///< along the normal
  double most_damper_N = 0.0;         ///< largest force of the damper in this tick
  Vec3 normal = Vec3::Zero();
  double depth_mm = 0.0;  ///< along the normal
};

/// Part of a step of the force that the hand's motion explains.
struct MotionExplainedStep {
  /// Change of the force that the damper explains, along the normal. It also explains any part of
  /// this change.
  Vec3 damper_N = Vec3::Zero();
  /// Largest change that the spring explains. The direction is arbitrary, because a relief is
  /// curved.
  double spring_N = 0.0;
};
/// Returns the part of the step from `last` to `now` that the motion of the hand explains.
///
/// The result depends on the counted motion of the HIP and on the wall before this tick, not on the
/// force. The spring with the stiffness K explains K |dx| in any direction, where dx is the motion
/// of the HIP (CountedMotion::step_mm). The damper with the damping B explains B dv along the
/// normal, where dv is the change of the HIP's velocity (CountedMotion::change_mm_s).
///
/// In a tick in which the HIP itself enters the surface, the spring explains K times the depth, and
/// the damper explains nothing. The HIP enters by itself if the depth is at most its motion
/// inwards.
///
/// A change of stiffness, surface or contact by the stream explains nothing. A predicted motion
/// explains nothing either: if the motion does not occur, a stream would cause the steps.
MotionExplainedStep computeStepAllowedByMotion(const StepState& now,
                                               const StepState& last) noexcept;
/// Returns the largest part of the step that a hand can have caused. The function uses the filtered
/// velocity, so the result is more generous than that of computeStepAllowedByMotion(). The stream
/// has caused every step that is larger. Trust uses this result; the limit does not.
MotionExplainedStep computeStepPossibleByHand(const StepState& now, const StepState& last) noexcept;

/// Limits the step of the force in a tick. The limit is the part that the hand explains plus the
/// slew limit of the profile. The functions compare only the forces of two successive ticks.
class StepLimit {
 public:
  explicit StepLimit(const DeviceProfile& profile) noexcept;
  /// Returns by how much the step from `last_N` to `force_N` exceeds the limit, N. The result is 0
  /// within the limit. It is infinity for a force that is not finite.
  [[nodiscard]] double excess_N(const Vec3& force_N, const Vec3& last_N,
                                const MotionExplainedStep& hand) const noexcept;
  /// Returns the force to send in place of `force_N`, if the step from `last_N` is too large.
  /// Requires excess_N() > 0. Only the part of the step that the hand does not explain is
  /// shortened. A plain slew limit would pump energy into the hand.
  [[nodiscard]] Vec3 limitForce(const Vec3& force_N, const Vec3& last_N,
                                const MotionExplainedStep& hand) const noexcept;

 private:
  struct Step {
    Vec3 explained_N;
    Vec3 rest_N;
    double allowed_N;  // largest allowed length of rest_N
  };
  [[nodiscard]] Step computeStep(const Vec3& force_N, const Vec3& last_N,
                                 const MotionExplainedStep& hand) const noexcept;

  double rise_N_, fall_N_, peak_N_;
};

}  // namespace hapticast::client
