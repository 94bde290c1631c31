// SPDX-License-Identifier: MIT
// Observer of the HIP (Smith predictor). It estimates the state of the HIP from its counts and from
// the sent forces. It predicts that state until a force sent now acts. The wall's own force is an
// input, so the filter can be slow; a slow filter makes single counts inaudible. The law and its
// measurements are in client/haptics/README.md, section 5a.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Delay line of the sent forces.
class SentForces {
 public:
  void add(const Vec3& force_N) noexcept {
    newest_ = (newest_ + 1) % kKept;
    sent_N_.col(newest_) = force_N;
  }
  /// Returns the force sent `ticks` ago, 1 (the last one) to 8.
  [[nodiscard]] Vec3 ago(int ticks) const noexcept {
    return sent_N_.col((newest_ + 1 + kKept - ticks) % kKept);
  }

 private:
  static constexpr int kKept = 8;
  Eigen::Matrix<double, 3, kKept> sent_N_ = Eigen::Matrix<double, 3, kKept>::Zero();
  int newest_ = 0;
};

/// Recursive least squares of the effective mass, axis by axis: the share (0.04..1) of F / m by
/// which the HIP responds to a force. 1 is the bare device; 0.05 is a rigidly held arm of twenty
/// times the mass. Force and counts pass the same filters. The rest above about 30 Hz is no
/// intention of a hand, and the regression of both is the share.
class EffectiveMassEstimator {
 public:
  /// `mass_kg` is the mass of the bare device.
  explicit EffectiveMassEstimator(double mass_kg) noexcept;
  /// Starts over at a position; the share remains.
  void restart(const Vec3& measured_mm, const Vec3& acting_N) noexcept;
  /// Processes a tick that ended at `measured_mm` and in which `acting_N` acted.
  void update(const Vec3& measured_mm, const Vec3& acting_N) noexcept;
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

/// State of the HIP, device frame.
struct HipState {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
};

/// The observer. One per device; all vectors in the device frame.
class HipObserver {
 public:
  explicit HipObserver(const DeviceProfile& profile) noexcept;

  /// Restarts at `tip`. Assumes that the hand balances the force `acting_N`, as a pressing hand
  /// does.
  void restart(const HipState& tip, const Vec3& acting_N) noexcept;
  /// Processes a tick that ended at the count `measured_mm` and in which `acting_N` acted.
  /// `wall_N_mm` is the stiffness of the wall; it determines the slowest pole.
  void update(const Vec3& measured_mm, const Vec3& acting_N, double wall_N_mm) noexcept;
  /// Present state of the HIP.
  [[nodiscard]] const HipState& tip() const noexcept { return tip_; }
  /// Predicts the state when a force sent now acts, plus two ticks of margin. `delay_ticks` is
  /// 0..5.
  [[nodiscard]] HipState ahead(const SentForces& sent, int delay_ticks) const noexcept;

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
  Vec3 rest_ticks_ = Vec3::Zero();  // ticks since the last change of the count
  Vec3 pole_rad_s_ = Vec3::Zero();  // triple pole of the observer
};

}  // namespace hapticast::client
