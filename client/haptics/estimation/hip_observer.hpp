// SPDX-License-Identifier: MIT
// Where the tip is, how it moves and where it will be, from its counts and from the forces that
// were sent: a wall whose own force is known needs no fast filter, and a slow one makes counts
// inaudible. The law and its measurements: client/haptics/README.md. Real-time room.
#pragma once

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// The forces of the last ticks, as they were sent.
class SentForces {
 public:
  void add(const Vec3& force_N) noexcept {
    newest_ = (newest_ + 1) % kKept;
    sent_N_.col(newest_) = force_N;
  }
  /// 1: the last one, at most 8.
  [[nodiscard]] Vec3 ago(int ticks) const noexcept {
    return sent_N_.col((newest_ + 1 + kKept - ticks) % kKept);
  }

 private:
  static constexpr int kKept = 8;
  Eigen::Matrix<double, 3, kKept> sent_N_ = Eigen::Matrix<double, 3, kKept>::Zero();
  int newest_ = 0;
};

/// How much of F / m the tip really answers a force with, axis by axis: 1 the bare device's mass,
/// 0.05 an arm of twenty times that, held stiffly. Force and counts pass the same filters; what is
/// left of both beyond some 30 Hz is no hand's intention, and their regression is the share.
class EffectiveMassEstimator {
 public:
  explicit EffectiveMassEstimator(double mass_kg) noexcept;
  void restart(const Vec3& measured_mm, const Vec3& acting_N) noexcept;
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

/// Device frame.
struct HipState {
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
};

class HipObserver {
 public:
  explicit HipObserver(const DeviceProfile& profile) noexcept;

  /// Begins anew. The hand is taken to balance the force: one that presses does.
  void restart(const HipState& tip, const Vec3& acting_N) noexcept;
  /// A tick that ended with this count and in which `acting_N` acted; `wall_N_mm`: stiffness of the
  /// wall, which says how fast a filter has to be at least.
  void update(const Vec3& measured_mm, const Vec3& acting_N, double wall_N_mm) noexcept;
  /// The tip now.
  [[nodiscard]] const HipState& tip() const noexcept { return tip_; }
  /// The tip that a force sent now will find, and a little further.
  [[nodiscard]] HipState ahead(const SentForces& sent, int delay_ticks) const noexcept;

 private:
  void predict(HipState& tip, const Vec3& force_N) const noexcept;
  void correct(int axis, double residual_mm, double slowest_rad_s) noexcept;

  double count_mm_;
  double mm_s2_per_N_;
  EffectiveMassEstimator share_;
  HipState tip_;
  Vec3 hand_mm_s2_ = Vec3::Zero();  // what the hand does to the tip
  Vec3 mean_mm_ = Vec3::Zero();     // of the residual
  Vec3 last_mm_ = Vec3::Zero();
  Vec3 rest_ticks_ = Vec3::Zero();  // since the count last changed
  Vec3 pole_rad_s_ = Vec3::Zero();  // of the observer, three times the same
};

}  // namespace hapticast::client
