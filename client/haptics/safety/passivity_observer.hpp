// SPDX-License-Identifier: MIT
// Where the work of the force goes: meters at the ports of the loop, a passivity observer of what
// the contact generates with a controller that damps it away (Hannaford, Ryu 2002), and an energy
// tank on the user's port. 1 N·mm = 1 mJ. Real-time room.
#pragma once

#include <array>
#include <cstddef>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// Work of the force on the hand since the beginning, mJ; > 0: into the hand.
struct PortWork {
  double relative_mJ = 0.0;  ///< of wall and inertia against the surface's motion: must be passive
  double surface_mJ = 0.0;   ///< of wall and inertia along it: the intended push
  double object_mJ = 0.0;    ///< of the object's force
  [[nodiscard]] double user_mJ() const noexcept { return relative_mJ + surface_mJ + object_mJ; }
};

/// What the meters have to know of the tick that ended with this position.
struct PortTick {
  Vec3 position_mm = Vec3::Zero();  ///< of the tip, measured
  bool connected = true;            ///< with the last one; else the tip made no way
  Vec3 surface_mm = Vec3::Zero();   ///< the surface at the contact, as it was announced
  // Energy of the spring at this tick's depth and at the last one's, each with the stiffness of its
  // own tick (a stream that stiffens a pressed spring gives energy), both with this tick's gain
  // (else a force that fades in would read as generated).
  double stored_mJ = 0.0;
  double stored_before_mJ = 0.0;
  bool contact = false;
  bool jump = false;  ///< of world or measurement: the observer starts over
};

/// A counted position moves late and by leaps; a leap times the force of its tick would read as
/// work that nobody did (F x count for each press). So the tip is where the count leaves it no
/// other choice to be (half a count of play), and a way is paid with the mean force since the last
/// one, axis by axis.
class PassivityObserver {
 public:
  PassivityObserver(int delay_ticks, double count_mm) noexcept : half_count_mm_(0.5 * count_mm) {
    setDelay(delay_ticks);
  }
  /// Ticks between reading a position and the begin of its force (0..kMostDelay_ticks).
  void setDelay(int delay_ticks) noexcept;

  /// Meters a tick with the force that acted in it: the one sent 1 + delay ticks before. Returns
  /// its work on the hand, mJ.
  double meter(const PortTick& tick) noexcept;
  /// What goes to the device after this tick; `dynamic_N`: the object's share of it.
  void sent(const Vec3& force_N, const Vec3& dynamic_N) noexcept;

  /// Damping to be added along the normal at the relative speed u: (G - 3 mJ) / (T u²), at most
  /// 5 N·s/m; 0 below 5 mm/s.
  [[nodiscard]] double damping_Ns_m(double u_mm_s) const noexcept;
  /// The observer G: what the contact has given beyond what it was given, forgotten within 1 s.
  [[nodiscard]] double generated_mJ() const noexcept { return generated_mJ_; }
  [[nodiscard]] const PortWork& work() const noexcept { return work_; }

 private:
  struct Sent {
    Vec3 force_N = Vec3::Zero();
    Vec3 dynamic_N = Vec3::Zero();
  };
  [[nodiscard]] Vec3 wayTo(const PortTick& tick) noexcept;

  double half_count_mm_;
  Vec3 at_mm_ = Vec3::Zero();
  Vec3 counted_mm_ = Vec3::Zero();  // as measured last
  Vec3 leap_mm_ = Vec3::Zero();     // the last one of each axis
  // Of the ticks since each axis last moved.
  Vec3 static_sum_N_ = Vec3::Zero();
  Vec3 dynamic_sum_N_ = Vec3::Zero();
  Vec3 ticks_ = Vec3::Zero();
  std::array<Sent, 8> sent_;  // ring
  std::size_t newest_ = 0;
  std::size_t age_ = 1;  // of the force that acted
  PortWork work_;
  double generated_mJ_ = 0.0;
  int free_ticks_ = 0;
};

/// Energy that the force may give to the hand: refilled by a constant power and by the hand itself.
/// What was given beyond the content is a debt, to be refilled first (at most one tank, so that one
/// broken number does not end the touch). The power comes out of a reserve that is worth 0.3 s of
/// it and grows by a fifth of it, and by what the hand gives to a full tank: over any 10 s a stream
/// gives at most the tank, the reserve and 10 s of that fifth (Omni: 475 mJ), however it shakes.
class EnergyTank {
 public:
  explicit EnergyTank(const DeviceProfile& profile) noexcept;
  /// Takes out the work of a tick (mJ, > 0: into the hand); the tip's velocity is smoothed within
  /// 5 ms, since that of single counts would make the limit chatter.
  void withdraw(double work_mJ, const Vec3& velocity_mm_s) noexcept;
  /// What the force is to be multiplied with: below 1 where it drives the hand faster than 10 mm/s
  /// with more than the tank could pay for 20 ms.
  [[nodiscard]] double factor(const Vec3& force_N) const noexcept;
  [[nodiscard]] double content_mJ() const noexcept { return content_mJ_; }  ///< < 0: a debt

 private:
  double most_mJ_, refill_W_, content_mJ_;
  double most_reserve_mJ_, reserve_mJ_;
  Vec3 velocity_mm_s_ = Vec3::Zero();
};

}  // namespace hapticast::client
