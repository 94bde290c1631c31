// SPDX-License-Identifier: MIT
// Safety actions and halts. A safety action is a step of the safety chain that changed the force.
// The tick report has one bit for each action.
// Thread: any.
#pragma once

#include <array>
#include <cstdint>

namespace hapticast::client {

/// The safety actions: the step of the chain that changed the force, or would have changed it.
enum class SafetyAction : std::uint8_t {
  /// A number was not finite or far too large. The last valid geometry is used while the force
  /// fades.
  kNotFinite,
  kSurfaceSpeed,  ///< the surface was faster than 1.5 m/s
  kStiffness,     ///< the stiffness was limited to K_max
  kNoPull,        ///< the damper would have pulled the hand into the wall
  kPeak,          ///< the force was clamped to the device's peak
  /// The force changed by more than the slew limit, and the hand's motion does not explain it.
  kSlew,
  kFade,         ///< the force fades in or out
  kDisarmed,     ///< the HIP is too deep after a jump, so there is no force until the HIP is out
  kResidue,      ///< an old force without a cause descends (release ramp)
  kJump,         ///< the scene or the measurement jumped
  kDamping,      ///< the author's damping was limited to what the delay allows
  kPassivity,    ///< the contact generated energy, so damping was added
  kTank,         ///< the energy tank reduced the force
  kThermal,      ///< the force was reduced because the motors are warm
  kLatency,      ///< the delay is longer than declared, so walls are softer and more damped
  kImplausible,  ///< the stream states a motion beyond its plausibility bounds
};
/// Name of each safety action in the log and in the summary, in the order of SafetyAction.
inline constexpr std::array<const char*, 16> kSafetyActionNames = {
    "not_finite", "surface_speed", "stiffness", "no_pull", "peak",    "slew",
    "fade",       "unarmed",       "residue",   "jump",    "damping", "passivity",
    "tank",       "thermal",       "latency",   "doubted"};
/// Returns the bit of `which` in TickReport::safety_actions.
constexpr std::uint32_t bit(SafetyAction which) noexcept {
  return std::uint32_t{1} << static_cast<unsigned>(which);
}

/// Returns a text for the user that describes the action. The text is empty for actions that have
/// no perceptible effect.
constexpr const char* toText(SafetyAction which) noexcept {
  switch (which) {
    case SafetyAction::kStiffness:
      return "a wall was made softer";
    case SafetyAction::kSurfaceSpeed:
      return "a surface was slowed down";
    case SafetyAction::kPassivity:
      return "a contact that generated energy was damped";
    case SafetyAction::kTank:
      return "the energy into the hand was limited";
    case SafetyAction::kSlew:
      return "a step was slowed";
    case SafetyAction::kPeak:
      return "the force was cut at the device's peak";
    case SafetyAction::kThermal:
      return "the force was cut for warm motors";
    case SafetyAction::kDisarmed:
      return "there was no force until the hand left the object";
    case SafetyAction::kNotFinite:
      return "an invalid number was ignored";
    case SafetyAction::kImplausible:
      return "implausible motion was rejected";
    default:
      return "";
  }
}

/// Cause of a halt. During a halt there is no force, until UserControls::rearm ends it.
enum class Halt : std::uint8_t {
  kNone = 0,
  kDeviceLost,
  kTrustLost,    ///< too many safety actions due to the stream (trust.hpp)
  kStopped,      ///< the loop ends, or the user stopped the force
  kUnconfirmed,  ///< the device was detected automatically, and the user has not confirmed it
};

}  // namespace hapticast::client
