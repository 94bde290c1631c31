// SPDX-License-Identifier: MIT
// Sees the tip swing in the wall in a way no hand does: the sign of a delay longer than the profile
// says. Real-time room.
#pragma once

#include "common/geometry.hpp"

namespace hapticast::client {

/// Twelve reversals of the tip along the normal of at least 3 counts each, none smaller than 0.9 of
/// the one before, each within 33 ms of the last (a tremor is slower) and not the surface's own (it
/// moved less than half the swing). Measured: client/haptics/README.md, 5.
class OscillationDetector {
 public:
  explicit OscillationDetector(double count_mm) noexcept : least_swing_mm_(3.0 * count_mm) {}

  /// A tick: ways of tip and surface along the normal; `acts`: a force acts (a swing out of the
  /// wall and back is one, so it may pause for 33 ms). Returns whether this tick completes an
  /// alarm; then it starts over.
  bool alarmed(double moved_mm, double surface_mm, bool acts) noexcept;

 private:
  struct Point {
    double tip_mm = 0.0;  // ways along the normal since the beginning
    double surface_mm = 0.0;
    int tick = 0;
  };
  struct State {
    Point now;
    Point extreme;  // farthest since the last reversal
    Point before;   // the extreme before that
    double direction = 1.0;
    double last_swing_mm = 0.0;
    int reversals = 0;
    int idle_ticks = 0;
  };
  void judgeSwing() noexcept;

  double least_swing_mm_;
  State state_;
};

/// Three contacts in a row that a tip leaves at least 0.9 times as fast as it came, each shorter
/// than the bare device on the wall's spring can last, within 0.25 s of one another, under a force
/// and not carried by the surface (less than half of the speed is its own): a damped wall gives
/// back half of the speed at most, and a hand that taps brings its own mass.
class BounceDetector {
 public:
  struct Tick {
    Vec3 tip_mm_s;
    // Of the surface; without contact they do not count.
    Vec3 surface_mm_s;
    Vec3 normal;
    double stiffness_N_mm;  ///< along the normal
    bool contact;
    bool acts;  ///< a force acts
    bool jump;  ///< nothing connects this tick with the one before
  };
  explicit BounceDetector(double mass_kg) noexcept : mass_kg_(mass_kg) {}

  /// Returns whether this tick completes an alarm; then it starts over.
  bool alarmed(const Tick& tick, int delay_ticks) noexcept;

 private:
  struct State {
    Vec3 normal = Vec3::Zero();  // of the contact
    Vec3 surface_mm_s = Vec3::Zero();
    double in_mm_s = 0.0, out_mm_s = 0.0;  // the fastest of this contact, against the surface
    double carried_mm_s = 0.0;             // the fastest of the surface itself
    int contact_ticks = 0, free_ticks = 0, longest_ticks = 0, bounces = 0;
    bool acted = false;
  };
  [[nodiscard]] int bouncesUpToNow() const noexcept;

  double mass_kg_;
  State state_;
};

}  // namespace hapticast::client
