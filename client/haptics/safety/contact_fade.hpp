// SPDX-License-Identifier: MIT
// Fade and arming of the force (step 9 of the safety chain). The gain of the wall rises in 0.2 s
// and falls in 0.1 s, by a smoothstep.
//
// After a jump of the scene the transfer is bumpless: the new wall begins with the gain at which
// its force continues the old force, and the rest of the old force follows a release ramp. A rise
// of the gain adds energy to a pressed spring. The discontinuity account pays for it, or the gain
// does not rise.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>

#include "client/haptics/safety/discontinuity_account.hpp"
#include "common/geometry.hpp"

namespace hapticast::client {

/// Duration of the fades, as the share of a tick: 0.2 s and 0.1 s. Chosen: neither a blow nor a
/// delay for the hand.
inline constexpr double kFadeIn = kTick_s / 0.2;
inline constexpr double kFadeOut = kTick_s / 0.1;

/// Input of one tick.
struct FadeTick {
  bool jump = false;       ///< the scene or the measurement does not continue that of the last tick
  bool touchable = false;  ///< a force may act
  bool contact = false;
  bool too_deep = false;  ///< the HIP is deeper than the arming depth
  /// Energy of the wall's spring at full gain.
  double spring_mJ = 0.0;
  /// Energy that the spring got in a gap of the measurement: the force was constant while the HIP
  /// moved.
  double gap_mJ = 0.0;
  // Forces at full gain, and the share of wall and inertia in them.
  Vec3 full_N = Vec3::Zero();
  Vec3 full_static_N = Vec3::Zero();
  // The same for the force that the last tick sent.
  Vec3 last_N = Vec3::Zero();
  Vec3 last_static_N = Vec3::Zero();
};

class ContactFade {
 public:
  /// `residue_step_N` is the release ramp: the old force descends by this much per tick. `fades` =
  /// false omits fades and ramps, and `arms` = false omits the arming depth.
  ContactFade(double residue_step_N, bool fades, bool arms) noexcept
      : residue_step_N_(residue_step_N), fades_(fades), arms_(arms) {}

  /// Advances fade, release ramp and arming by one tick. Returns the bits of the safety actions
  /// that acted. `account` pays for each rise of the gain.
  std::uint32_t step(const FadeTick& tick, DiscontinuityAccount& account) noexcept;
  /// Sets the gain to 0. The next tick with FadeTick::touchable checks the arming depth again.
  void restart() noexcept;

  /// Returns the gain of the wall and of the dynamic force, 0..1.
  [[nodiscard]] double gain() const noexcept;
  /// Returns the rest of an old force on its release ramp.
  [[nodiscard]] const Vec3& residue_N() const noexcept { return residue_N_; }
  /// Returns the share of wall and inertia in residue_N().
  [[nodiscard]] const Vec3& residueStatic_N() const noexcept { return residue_static_N_; }

 private:
  void onJump(const FadeTick& tick, DiscontinuityAccount& account) noexcept;
  void onGap(const FadeTick& tick, DiscontinuityAccount& account) noexcept;
  void advance(const FadeTick& tick, bool armed, DiscontinuityAccount& account) noexcept;
  void rampDown() noexcept;

  double residue_step_N_;
  bool fades_, arms_;
  double fade_ = 0.0;       // 0..1, before the smoothstep
  double stored_mJ_ = 0.0;  // energy of the rendered spring in the last tick
  bool touched_ = false;    // the last tick had a contact
  Vec3 residue_N_ = Vec3::Zero();
  Vec3 residue_static_N_ = Vec3::Zero();
  bool check_depth_ = true;  // the next geometry under which a force may act decides about arming
  bool blocked_ = false;     // disarmed: too deep after a jump
};

}  // namespace hapticast::client
