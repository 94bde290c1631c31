// SPDX-License-Identifier: MIT
// Oscillation detection: recognises swings and bounces of the HIP at a wall that no hand causes.
// They are the sign of a delay longer than the profile declares. client/haptics/README.md, section
// 5, has the measurements.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "common/geometry.hpp"

namespace hapticast::client {

/// Detects swings in the wall: twelve reversals of the HIP along the normal, each of at least 3
/// counts. No swing is smaller than 0.9 of the swing before, and each lasts less than 33 ms (a
/// tremor is slower). The surface makes less than half of each swing.
class OscillationDetector {
 public:
  explicit OscillationDetector(double count_mm) noexcept : least_swing_mm_(3.0 * count_mm) {}

  /// Processes a tick with the motions of HIP and surface along the normal, mm. `acts`: a force
  /// acts. The force may pause for 33 ms, because a swing can leave the wall. Returns true if this
  /// tick completes an alarm. The detector then starts over.
  bool alarmed(double moved_mm, double surface_mm, bool acts) noexcept;

 private:
  struct Point {
    double tip_mm = 0.0;  // motions along the normal since the start
    double surface_mm = 0.0;
    int tick = 0;
  };
  struct State {
    Point now;
    Point extreme;  // farthest point since the last reversal
    Point before;   // the extreme before
    double direction = 1.0;
    double last_swing_mm = 0.0;
    int reversals = 0;
    int idle_ticks = 0;
  };
  void judgeSwing() noexcept;

  double least_swing_mm_;
  State state_;
};

/// Detects bounces: three contacts in a row that the HIP leaves with at least 0.9 of its speed.
/// Each contact is shorter than the bare device on the wall's spring can last, and the next follows
/// within 0.25 s. It counts only under a force, and if the surface makes less than half of the
/// speed. A damped wall returns at most half of the speed, and a tapping hand adds its own mass.
class BounceDetector {
 public:
  struct Tick {
    Vec3 tip_mm_s;
    // Of the surface; unused without contact.
    Vec3 surface_mm_s;
    Vec3 normal;
    double stiffness_N_mm;  ///< along the normal
    bool contact;
    bool acts;  ///< a force acts
    bool jump;  ///< no connection with the tick before
  };
  explicit BounceDetector(double mass_kg) noexcept : mass_kg_(mass_kg) {}

  /// Processes a tick. `delay_ticks` is the delay in use. Returns true if this tick completes an
  /// alarm; the detector then starts over.
  bool alarmed(const Tick& tick, int delay_ticks) noexcept;

 private:
  struct State {
    Vec3 normal = Vec3::Zero();  // of the contact
    Vec3 surface_mm_s = Vec3::Zero();
    // Largest speeds of this contact, relative to the surface.
    double in_mm_s = 0.0, out_mm_s = 0.0;
    double carried_mm_s = 0.0;  // largest speed of the surface itself
    int contact_ticks = 0, free_ticks = 0, longest_ticks = 0, bounces = 0;
    bool acted = false;
  };
  [[nodiscard]] int bouncesUpToNow() const noexcept;

  double mass_kg_;
  State state_;
};

}  // namespace hapticast::client
