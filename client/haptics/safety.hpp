// SPDX-License-Identifier: MIT
// The safety chain: from where the tip should be (geometry) and the dynamic force to the force a
// device may feel. Nothing reaches the device around it. Laws and constants: stability notes,
// section 5. Real-time room.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "client/haptics/haptic_device.hpp"

namespace hapticast::client {

/// A step of the chain that changed the force (or would have), for the report and the summary.
enum class Interference : std::uint8_t {
  kNotFinite,     ///< a number was not finite; the last geometry is held and fades
  kSurfaceSpeed,  ///< the surface moved faster than 1.5 m/s
  kStiffness,     ///< the stiffness was cut to K_max
  kNoPull,        ///< the damper would have pulled
  kPeak,          ///< clamped to the device's peak
  kSlew,          ///< a step the hand's motion does not explain was slowed
  kFade,          ///< the force is fading in or out
  kUnarmed,       ///< too deep after a jump: no force until the hand has left
  kResidue,       ///< an old force ramps down
  kJump,          ///< the world or the measurement jumped
};
inline constexpr std::array<const char*, 10> kInterferenceNames = {
    "not_finite", "surface_speed", "stiffness", "no_pull", "peak",
    "slew",       "fade",          "unarmed",   "residue", "jump"};
constexpr std::uint32_t bit(Interference which) noexcept {
  return std::uint32_t{1} << static_cast<unsigned>(which);
}

/// tau of the wall law in s for a delay in ticks (0..5, beyond: 5).
double wallLead_s(int delay_ticks) noexcept;
/// K_max = min(10, 0.65 m / tau²) in N/mm.
double stiffnessLimit_N_mm(const DeviceProfile& profile) noexcept;
/// Damping of the wall law in N·s/m for a local stiffness: B = K tau + B_0.
double wallDamping_Ns_m(double stiffness_N_mm, double lead_s) noexcept;

/// Deeper (device mm) than max(2 mm, peak/K) after a jump nothing arms until the hand has left.
double armDepth_mm(double stiffness_N_mm, double peak_N) noexcept;

/// Device frame, device mm.
struct SafetyInput {
  // The tip.
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  bool measurement_jumped =
      false;                 ///< position and velocity are not connected with the last tick's
  bool device_lost = false;  ///< latched; only rearm() ends it
  // What it touches.
  bool contact = false;
  Vec3 displacement_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  Vec3 surface_velocity_mm_s = Vec3::Zero();
  double stiffness_factor = 1.0;  ///< |displacement| over depth along the normal
  double stiffness_N_mm = 0.5;
  bool world_jumped = false;  ///< epoch, connection, mapping
  bool touchable = false;     ///< the scene is fresh enough to be felt
  Vec3 dynamic_N = Vec3::Zero();
  bool dynamic_valid = false;  ///< else the dynamic force fades out
};

struct SafetyOutput {
  Vec3 force_N = Vec3::Zero();          ///< what goes to the device
  Vec3 static_force_N = Vec3::Zero();   ///< the wall law
  Vec3 dynamic_force_N = Vec3::Zero();  ///< after its fade
  double penetration_mm = 0.0;          ///< |displacement| used, device mm
  bool contact = false;
  bool not_finite = false;
  double step_excess_N = 0.0;  ///< of StepMeter
  std::uint32_t interferences = 0;
};

/// What the meter and the slew limit have to know of a tick.
struct StepState {
  Vec3 force_N = Vec3::Zero();
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  // Without contact: zero.
  bool contact = false;
  double local_stiffness_N_mm = 0.0;  ///< along the normal
  Vec3 normal = Vec3::Zero();
  double depth_mm = 0.0;  ///< along the normal
};

/// Measures the finished force: how far its step exceeds what the hand's own motion explains and S
/// more. The hand explains, in the wall it touched before the tick: K|dx| in any direction, B dv
/// along the normal (or a part of it), and where the tip itself enters (the depth is at most its
/// way inwards) K depth and B v; velocities no larger than the damper's limit. Knows nothing of how
/// the force was made. Must read 0 always; infinite when the force is not finite.
class StepMeter {
 public:
  explicit StepMeter(const DeviceProfile& profile) noexcept;
  double excess_N(const StepState& now, bool measurement_jumped) noexcept;

 private:
  double rise_N_, fall_N_, lead_s_;
  StepState last_;
};

class SafetyChain {
 public:
  /// Copies what it needs of the profile.
  explicit SafetyChain(const DeviceProfile& profile) noexcept;

  SafetyOutput step(const SafetyInput& input) noexcept;
  /// A force acts on the device (it did at the last tick).
  [[nodiscard]] bool acts() const noexcept { return last_.force_N != Vec3::Zero(); }
  /// From outside, after a lost device came back or stop(): the force may return, from zero.
  void rearm() noexcept;
  /// Ramps the force to zero and keeps it there until rearm().
  void stop() noexcept { stop_requested_ = true; }

 private:
  struct Geometry {
    bool contact = false;
    Vec3 displacement_mm = Vec3::Zero();
    Vec3 normal = Vec3::UnitZ();
    Vec3 surface_velocity_mm_s = Vec3::Zero();
    double stiffness_factor = 1.0;
    double stiffness_N_mm = 0.0;  // K_r
  };

  Geometry plausible(const SafetyInput& input, SafetyOutput& out) noexcept;
  Geometry heldGeometry(const Vec3& position_mm) const noexcept;
  bool jumped(const SafetyInput& input, const Geometry& geometry) const noexcept;
  Vec3 wallForce(const SafetyInput& input, const Geometry& geometry,
                 SafetyOutput& out) const noexcept;
  Vec3 dynamicForce(const SafetyInput& input, const Geometry& geometry, SafetyOutput& out) noexcept;
  void fadeAndArm(bool jump, bool touchable, const Geometry& geometry, SafetyOutput& out) noexcept;
  Vec3 clamped(const Vec3& force_N, SafetyOutput& out) const noexcept;
  Vec3 slewed(const Vec3& target_N, const StepState& now, bool measurement_jumped,
              SafetyOutput& out) const noexcept;

  double peak_N_, rise_N_, fall_N_, residue_step_N_, lead_s_, stiffness_limit_N_mm_;
  StepMeter meter_;
  StepState last_;
  Geometry geometry_;  // of the last tick
  bool stop_requested_ = false;
  bool halted_ = false;  // by a lost device or stop(), until rearm()
  double fade_ = 0.0;    // 0..1, smoothed before use
  double dynamic_fade_ = 0.0;
  Vec3 dynamic_N_ = Vec3::Zero();  // last valid one
  Vec3 residue_N_ = Vec3::Zero();
  bool check_depth_ = true;  // the next touchable geometry decides whether we may arm
  bool blocked_ = false;     // too deep after a jump
};

}  // namespace hapticast::client
