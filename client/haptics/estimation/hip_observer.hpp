// SPDX-License-Identifier: MIT
// Observer of the HIP (Smith predictor). It estimates position and velocity of the HIP from the
// measured positions and the sent forces. It then predicts both for the time when a force sent now
// acts. The sent force is an input of the observer, so the observer need not derive the effect of
// the wall from the positions. So its filter can be slow, and a slow filter hides single encoder
// counts from the hand. The law and its measurements are in client/haptics/stability.md.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Stores the last eight forces that were sent to the device.
class SentForces {
 public:
  void add(const Vec3& force_N) noexcept {
    newest_ = (newest_ + 1) % kKept;
    sent_N_.col(newest_) = force_N;
  }
  /// Returns the force that was sent `ticks` ticks ago, from 1 (the last one) to 8.
  [[nodiscard]] Vec3 ago(int ticks) const noexcept {
    return sent_N_.col((newest_ + 1 + kKept - ticks) % kKept);
  }

 private:
  static constexpr int kKept = 8;
  Eigen::Matrix<double, 3, kKept> sent_N_ = Eigen::Matrix<double, 3, kKept>::Zero();
  int newest_ = 0;
};

/// Estimates the effective mass of the HIP on each axis, by recursive least squares. A hand on the
/// device adds its mass, so the HIP responds less to a force. The estimate is a share, 0.04..1: the
/// acceleration under a force, divided by that of the bare device. 1 is the bare device. At 0.05,
/// device and hand together have twenty times the mass of the device.
///
/// Filters remove the content below about 30 Hz from the force and from the measured position,
/// because deliberate motion of a hand is slower. They also account for the double integration from
/// force to position. The share follows from a regression between the two filtered signals.
class EffectiveMassEstimator {
 public:
  /// `mass_kg` is the mass of the bare device.
  explicit EffectiveMassEstimator(double mass_kg) noexcept;
  /// Restarts the filters at the position `measured_mm` under the force `acting_N`. The estimated
  /// share remains.
  void restart(const Vec3& measured_mm, const Vec3& acting_N) noexcept;
  /// Processes one tick, which ended at the position `measured_mm`. The force `acting_N` acted in
  /// this tick.
  void update(const Vec3& measured_mm, const Vec3& acting_N) noexcept;
  /// Returns the share of each axis, 0.04..1.
  [[nodiscard]] const Vec3& value() const noexcept { return share_; }

 private:
  double newton_per_mm_;
  static constexpr int kFilters = 4;
  using Filters = Eigen::Matrix<double, 3, kFilters>;
  Filters slow_N_ = Filters::Zero();
  Filters slow_mm_ = Filters::Zero();
  Vec3 last_N_ = Vec3::Zero();
  Vec3 product_N2_ = Vec3::Zero();
  Vec3 square_N2_ = Vec3::Zero();
  Vec3 share_ = Vec3::Ones();
};

/// Margin of the prediction, ticks: a device may answer this much later than its profile declares.
/// Measured: with a margin of 0.5 or 1 tick, a bare device that is one tick late becomes unstable
/// at K_max.
inline constexpr int kPredictionMargin_ticks = 2;

/// Position and velocity of the HIP in the device frame.
struct HipState {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
};

/// The observer of one device. All vectors are in the device frame.
class HipObserver {
 public:
  explicit HipObserver(const DeviceProfile& profile) noexcept;

  /// Restarts at the state `tip`. The observer assumes that the hand balances the force `acting_N`,
  /// as a pressing hand does.
  void restart(const HipState& tip, const Vec3& acting_N) noexcept;
  /// Processes one tick, which ended at the measured position `measured_mm`. The force `acting_N`
  /// acted in this tick. `wall_N_mm` is the stiffness of the wall. A stiffer wall makes the filter
  /// slower at rest.
  void update(const Vec3& measured_mm, const Vec3& acting_N, double wall_N_mm) noexcept;
  /// Returns the present state of the HIP.
  [[nodiscard]] const HipState& tip() const noexcept { return tip_; }
  /// Returns the predicted state for the time when a force that is sent now acts, plus
  /// kPredictionMargin_ticks. `sent` has the forces that were sent before. `delay_ticks` (0..5) is
  /// the delay from a position to its force.
  [[nodiscard]] HipState predictAhead(const SentForces& sent, int delay_ticks) const noexcept;

 private:
  void predict(HipState& tip, const Vec3& force_N) const noexcept;
  void correct(int axis, double residual_mm, double slowest_rad_s) noexcept;

  double count_mm_;
  double mm_s2_per_N_;
  EffectiveMassEstimator share_;
  HipState tip_;
  Vec3 hand_mm_s2_ = Vec3::Zero();  // acceleration that the hand causes
  Vec3 mean_mm_ = Vec3::Zero();     // mean of the residual
  Vec3 last_mm_ = Vec3::Zero();
  Vec3 rest_ticks_ = Vec3::Zero();  // ticks since the last change of the measured position
  Vec3 pole_rad_s_ = Vec3::Zero();  // triple pole of the observer
};

}  // namespace hapticast::client
