// SPDX-License-Identifier: MIT
// Energy meters and energy limits. The meters measure the work of the force on the hand, split by
// its cause (PortWork). Two limits use them. The passivity observer detects energy that a contact
// generates, and damps it (Hannaford and Ryu 2002). The energy tank bounds the energy into the
// hand, whatever the cause. 1 N·mm is 1 mJ.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <array>
#include <cstddef>

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/safety/wall_law.hpp"

namespace hapticast::client {

/// Work of the force on the hand since the start, mJ. A positive value is energy into the hand. The
/// three parts are the ports of the loop: each port is one cause of the work.
struct PortWork {
  /// Work of the wall and of virtual inertia in the HIP's motion relative to the surface. It must
  /// be passive.
  double relative_mJ = 0.0;
  /// Work of the wall and of virtual inertia in the surface's own motion. This push is intended.
  double surface_mJ = 0.0;
  double object_mJ = 0.0;  ///< work of the object's dynamic force in the HIP's motion
  /// Returns the whole work on the hand.
  [[nodiscard]] double user_mJ() const noexcept { return relative_mJ + surface_mJ + object_mJ; }
};

/// Stores the motion of the surface in the last ticks. The contact is computed for the predicted
/// HIP, so its surface is some ticks ahead of the measured position. The meters need the motion at
/// the measured position.
class SurfaceHistory {
 public:
  /// Adds the surface's motion in one tick (mm), `ticks_ahead` ticks before it happens.
  /// `ticks_ahead` is at most 7.
  void add(const Vec3& step_mm, int ticks_ahead) noexcept;
  /// Returns the surface's motion in the tick that just ended, mm.
  [[nodiscard]] Vec3 present_mm() const noexcept { return ago(ticks_ahead_); }
  /// Returns the surface's motion from now to the time of the contact, mm.
  [[nodiscard]] Vec3 coming_mm() const noexcept;

 private:
  static constexpr int kKept = kMostDelay_ticks + kPredictionMargin_ticks + 1;
  [[nodiscard]] Vec3 ago(int ticks) const noexcept {
    return step_mm_.col((newest_ + kKept - ticks) % kKept);
  }
  Eigen::Matrix<double, 3, kKept> step_mm_ = Eigen::Matrix<double, 3, kKept>::Zero();
  int newest_ = 0;
  int ticks_ahead_ = 0;
};

/// Input of the meters for one tick. The tick ended when the HIP was measured at `position_mm`.
struct PortTick {
  Vec3 position_mm = Vec3::Zero();  ///< HIP, measured
  /// False: the position does not continue that of the last tick, so it counts as no motion.
  bool connected = true;
  /// Motion of the surface at the contact in this tick, computed from the stream.
  Vec3 surface_mm = Vec3::Zero();
  // Energy of the wall's spring in this tick and in the last tick. Each value uses the depth and
  // the stiffness of its own tick, because a stream that stiffens a pressed spring adds energy.
  // Both values use the fade factor of this tick. Otherwise a fade in would count as generated
  // energy.
  double stored_mJ = 0.0;
  double stored_before_mJ = 0.0;
};

/// Meters the work at the ports, and computes the damping against generated energy.
///
/// A measured position is a whole number of encoder counts, so it moves late and in steps. The
/// product of a step and the force of its tick would count as work that the hand never did (one
/// count times the force for each press). So the meter follows the position with a dead zone of
/// half a count. It multiplies each motion by the mean force since the last motion on that axis.
class PassivityObserver {
 public:
  /// `delay_ticks` is as in setDelay(). `count_mm` is the size of an encoder count.
  PassivityObserver(int delay_ticks, double count_mm) noexcept : half_count_mm_(0.5 * count_mm) {
    setDelay(delay_ticks);
  }
  /// Sets the delay: the number of ticks from the reading of a position to the begin of its force.
  /// The value is clamped to 0..kMostDelay_ticks.
  void setDelay(int delay_ticks) noexcept;

  /// Adds one tick to the meters. The force that acted in this tick was sent 1 + delay ticks
  /// before. Returns its work on the hand in this tick, mJ; positive: into the hand.
  double meter(const PortTick& tick) noexcept;
  /// Records the force sent to the device after this tick. `dynamic_N` is the object's share of it.
  void sent(const Vec3& force_N, const Vec3& dynamic_N) noexcept;

  /// Returns the damping (N·s/m) along the normal that the wall has to add at the relative speed
  /// `u_mm_s`. It is (G - 3 mJ) / (T u²), with the generated energy G and the tick T. It is at most
  /// 5 N·s/m, and from G = 6 mJ to 12 mJ that limit grows to 15 N·s/m. The damping is 0 while G is
  /// below 3 mJ, and for speeds of at most 5 mm/s.
  [[nodiscard]] double damping_Ns_m(double u_mm_s) const noexcept;
  /// Returns G, the energy that all contacts have generated, mJ. G decays with a time constant of
  /// 10 s. Jumps and ends of a contact do not reset it: a contact that beats generates a little in
  /// each beat.
  [[nodiscard]] double generated_mJ() const noexcept { return generated_mJ_; }
  /// Returns the work at each port since the start.
  [[nodiscard]] const PortWork& work() const noexcept { return work_; }

 private:
  struct Sent {
    Vec3 force_N = Vec3::Zero();
    Vec3 dynamic_N = Vec3::Zero();
  };
  /// Follows the measured position with the dead zone of half a count. Returns the motion of this
  /// tick, mm.
  [[nodiscard]] Vec3 computeWay(const PortTick& tick) noexcept;

  double half_count_mm_;
  Vec3 at_mm_ = Vec3::Zero();
  Vec3 counted_mm_ = Vec3::Zero();  // last measured position
  Vec3 leap_mm_ = Vec3::Zero();     // last step of each axis
  // Since the last step of each axis.
  Vec3 static_sum_N_ = Vec3::Zero();
  Vec3 dynamic_sum_N_ = Vec3::Zero();
  Vec3 ticks_ = Vec3::Zero();
  std::array<Sent, 8> sent_;  // ring buffer
  std::size_t newest_ = 0;
  // Delay in ticks: the force that acted was sent this long before the newest one.
  std::size_t age_ = 1;
  PortWork work_;
  double generated_mJ_ = 0.0;
};

/// Energy tank: it bounds the energy that the force transfers into the hand.
///
/// The constants follow from the limits of a hand (hand_limits.hpp). The tank starts full, with
/// `tank_mJ` of the profile, at most 18.75 mJ. Work into the hand lowers the content, and
/// work by the hand raises it. A content below zero is a debt. The refill first repays the debt.
/// The debt is at most one tank, so that one broken number does not end the contact for long.
///
/// Each tick refills the tank with at most the power `tank_W`. A second store, the reserve,
/// supplies this energy. The full reserve lasts 0.3 s at that power, and has at most 60 mJ. A power
/// of 20 mW flows into the reserve all the time. Work by the hand that the full tank cannot store
/// flows into the reserve as well.
///
/// This bounds the energy that a stream can transfer, beyond the work of the hand itself. In any 10
/// s it is at most one tank, one full reserve, and 20 mW for 10 s. On an Omni that is 15 + 60 + 200
/// = 275 mJ, on any device at most 279 mJ.
class EnergyTank {
 public:
  explicit EnergyTank(const DeviceProfile& profile) noexcept;
  /// Withdraws the work of one tick (mJ, positive into the hand) and refills the tank for that
  /// tick. `velocity_mm_s` is the velocity of the HIP. A low-pass of 5 ms smooths it, because the
  /// velocity of single counts would make the limit chatter.
  void withdraw(double work_mJ, const Vec3& velocity_mm_s) noexcept;
  /// Returns the factor (0..1) by which the caller has to scale `force_N`. The factor is below 1
  /// only if two conditions hold: the force drives the hand faster than 10 mm/s, and the work of
  /// the next 20 ms exceeds the content.
  [[nodiscard]] double factor(const Vec3& force_N) const noexcept;
  [[nodiscard]] double content_mJ() const noexcept { return content_mJ_; }  ///< below 0: a debt

 private:
  double most_mJ_, refill_W_, content_mJ_;
  double most_reserve_mJ_, reserve_mJ_;
  Vec3 velocity_mm_s_ = Vec3::Zero();
};

}  // namespace hapticast::client
