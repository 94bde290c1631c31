// SPDX-License-Identifier: MIT
// What the safety chain does to a force, told of every tick.
#pragma once

#include <array>
#include <cstdint>

namespace hapticast::client {

/// A step of the chain that changed the force (or would have), for the report and the summary.
enum class SafetyAction : std::uint8_t {
  kNotFinite,     ///< a number was not finite, or absurd; the last geometry is held and fades
  kSurfaceSpeed,  ///< the surface moved faster than 1.5 m/s
  kStiffness,     ///< the stiffness was cut to K_max
  kNoPull,        ///< the damper would have pulled
  kPeak,          ///< clamped to the device's peak
  kSlew,          ///< a step the hand's motion does not explain was slowed
  kFade,          ///< the force is fading in or out
  kDisarmed,      ///< too deep after a jump: no force until the hand has left
  kResidue,       ///< an old force ramps down
  kJump,          ///< the world or the measurement jumped
  kDamping,       ///< the author's damping was cut to what the delay allows
  kPassivity,     ///< the contact gave energy it had not got: more damping
  kTank,          ///< shortened: too much energy into the hand
  kThermal,       ///< shortened: the motors are warm
  kLatency,       ///< the delay is longer than the profile says: a softer, more damped wall
  kImplausible,   ///< the stream's own frames do not bear out what it says: not believed
};
inline constexpr std::array<const char*, 16> kInterferenceNames = {
    "not_finite", "surface_speed", "stiffness", "no_pull", "peak",    "slew",
    "fade",       "unarmed",       "residue",   "jump",    "damping", "passivity",
    "tank",       "thermal",       "latency",   "doubted"};
constexpr std::uint32_t bit(SafetyAction which) noexcept {
  return std::uint32_t{1} << static_cast<unsigned>(which);
}

/// What it did, for a person; empty where a hand does not notice it.
constexpr const char* toText(SafetyAction which) noexcept {
  switch (which) {
    case SafetyAction::kStiffness:
      return "a wall was made softer";
    case SafetyAction::kSurfaceSpeed:
      return "a surface was slowed down";
    case SafetyAction::kPassivity:
      return "what a contact gave was damped";
    case SafetyAction::kTank:
      return "energy into the hand was held back";
    case SafetyAction::kSlew:
      return "a step was slowed";
    case SafetyAction::kPeak:
      return "the force was cut at the device's peak";
    case SafetyAction::kThermal:
      return "the force was cut for warm motors";
    case SafetyAction::kDisarmed:
      return "there was no force until the hand had left";
    case SafetyAction::kNotFinite:
      return "a number that was none, or absurd, was left out";
    case SafetyAction::kImplausible:
      return "motion that the pictures do not bear out was not believed";
    default:
      return "";
  }
}

/// Why there is no force until UserControls::rearm.
enum class Halt : std::uint8_t {
  kNone = 0,
  kDeviceLost,
  kTrustLost,    ///< the stream asked for too much that had to be held back
  kStopped,      ///< the loop is ending
  kUnconfirmed,  ///< automatic detection selected the device
};

}  // namespace hapticast::client
