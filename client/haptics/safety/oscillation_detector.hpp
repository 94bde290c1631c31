// SPDX-License-Identifier: MIT
// Oscillation detection at a wall. Swings and bounces that no hand can cause show that the delay of
// the device is longer than its profile declares. Two detectors recognise them: by twelve reversals
// of the HIP in a row, and by three bounces in a row. client/haptics/safety/README.md, "Delay
// longer than declared", has the measurements.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include "common/geometry.hpp"

namespace hapticast::client {

/// Detects swings of the HIP along the wall's normal. A swing is the motion between two reversals
/// of the direction.
///
/// Twelve reversals in a row complete an alarm, if each swing fulfils four conditions. It is at
/// least 3 encoder counts long. It has at least 0.9 of the length of the swing before. It lasts
/// less than 33 ms, because a slower swing can be a tremor of the hand. The surface itself moves by
/// less than half of the swing meanwhile.
class OscillationDetector {
 public:
  /// `count_mm` is the size of an encoder count.
  explicit OscillationDetector(double count_mm) noexcept : least_swing_mm_(3.0 * count_mm) {}

  /// Processes one tick. `moved_mm` and `surface_mm` are the motions of HIP and surface along the
  /// normal in this tick, mm. `acts` is true if a force acts. The force may pause for up to 33 ms,
  /// because a swing can leave the wall. Returns true if this tick completes an alarm. The detector
  /// then starts again.
  bool detectsAlarm(double moved_mm, double surface_mm, bool acts) noexcept;

 private:
  struct Point {
    double tip_mm = 0.0;  // sum of the motions along the normal since the start
    double surface_mm = 0.0;
    int tick = 0;
  };
  struct State {
    Point now;
    Point extreme;  // farthest point since the last reversal
    Point before;   // the farthest point before the reversal before
    double direction = 1.0;
    double last_swing_mm = 0.0;
    int reversals = 0;
    int idle_ticks = 0;
  };
  void judgeSwing() noexcept;

  double least_swing_mm_;
  State state_;
};

/// Detects bounces. A bounce is a short contact that the HIP leaves with at least 0.9 of its speed
/// before the contact.
///
/// Three bounces in a row complete an alarm. Each contact is shorter than the longest contact of
/// the bare device with the wall's spring. The next contact follows within 0.25 s. A bounce counts
/// only if a force acted, and if the surface's own speed is less than half of the HIP's. A hand
/// that taps cannot cause this: a damped wall returns at most half of the speed, and the hand adds
/// its own mass.
class BounceDetector {
 public:
  struct Tick {
    Vec3 tip_mm_s;
    // Velocity and normal of the surface. Both are unused without a contact.
    Vec3 surface_mm_s;
    Vec3 normal;
    double stiffness_N_mm;  ///< along the normal
    bool contact;
    bool acts;  ///< true if a force acts in this tick
    bool jump;  ///< the position does not continue that of the tick before
  };
  /// `mass_kg` is the mass of the bare device.
  explicit BounceDetector(double mass_kg) noexcept : mass_kg_(mass_kg) {}

  /// Processes one tick. `delay_ticks` is the result of SafetyChain::delayTicks(). Returns true if
  /// this tick completes an alarm. The detector then starts again.
  bool detectsAlarm(const Tick& tick, int delay_ticks) noexcept;

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
  [[nodiscard]] int countBounces() const noexcept;

  double mass_kg_;
  State state_;
};

}  // namespace hapticast::client
