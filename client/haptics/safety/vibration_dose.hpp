// SPDX-License-Identifier: MIT
// Vibration that a moving surface causes in the hand: the frequency-weighted root mean square
// acceleration of the last minute. The weighting of ISO 5349-1 (W_h) is a band limit at 6.3 Hz and
// a fall of 1/f from 16 Hz on. Two one-pole filters approximate it, within 15 % from 8 to 100 Hz.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

namespace hapticast::client {

class VibrationDose {
 public:
  /// Adds one tick. `surface_mm_s` and `hip_mm_s` are the speeds of surface and HIP along the
  /// normal; both are 0 where no force acts. The hand vibrates by the surface at most as fast as
  /// both.
  void add(double surface_mm_s, double hip_mm_s) noexcept;
  /// Returns the weighted acceleration, root mean square with a time constant of 60 s, m/s².
  [[nodiscard]] double rms_m_s2() const noexcept;

 private:
  double slow_mm_s_ = 0.0;    // speed below 6.3 Hz
  double smooth_mm_s_ = 0.0;  // the rest of the speed, below 16 Hz
  double square_m2_s4_ = 0.0;
};

}  // namespace hapticast::client
