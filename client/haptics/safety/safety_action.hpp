// SPDX-License-Identifier: MIT
// The safety actions: steps of the safety chain that changed the force. The tick report has one bit
// for each.
// Thread: any.
#pragma once

#include <array>
#include <cstdint>

namespace hapticast::client {

/// Steps of the chain that changed the force, or would have changed it.
enum class SafetyAction : std::uint8_t {
  kNotFinite,     ///< a number was not finite or absurd: the last geometry is held and fades
  kSurfaceSpeed,  ///< the surface was faster than 1.5 m/s
  kStiffness,     ///< the stiffness was limited to K_max
  kNoPull,        ///< the damper would have pulled
  kPeak,          ///< clamp to the device's peak
  kSlew,          ///< slew limit: a step that the hand's motion does not explain
  kFade,          ///< the force fades in or out
  kDisarmed,      ///< too deep after a jump: no force until the HIP is out
  kResidue,       ///< release ramp of an old force
  kJump,          ///< jump of scene or measurement
  kDamping,       ///< the author's damping was limited for the delay
  kPassivity,     ///< the contact generated energy: additional damping
  kTank,          ///< too much energy into the hand: force reduced
  kThermal,       ///< warm motors: force reduced
  kLatency,       ///< delay longer than declared: softer wall, more damping
  kImplausible,   ///< a statement of the stream beyond its plausibility bounds
};
/// Names in the log and in the summary, in the order of SafetyAction.
inline constexpr std::array<const char*, 16> kInterferenceNames = {
    "not_finite", "surface_speed", "stiffness", "no_pull", "peak",    "slew",
    "fade",       "unarmed",       "residue",   "jump",    "damping", "passivity",
    "tank",       "thermal",       "latency",   "doubted"};
/// Returns the bit of `which` in TickReport::interferences.
constexpr std::uint32_t bit(SafetyAction which) noexcept {
  return std::uint32_t{1} << static_cast<unsigned>(which);
}

/// Returns a text for the user; empty for actions that a hand does not notice.
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

/// Cause of a halt of the force. UserControls::rearm ends it.
enum class Halt : std::uint8_t {
  kNone = 0,
  kDeviceLost,
  kTrustLost,    ///< trust is spent: too many safety actions due to the stream
  kStopped,      ///< the loop ends
  kUnconfirmed,  ///< the device was detected automatically and awaits a confirmation
};

}  // namespace hapticast::client
