// SPDX-License-Identifier: MIT
// The safety chain computes the force for the device from the displacement and the dynamic force.
// The result is safe for device and hand, for every possible input from the stream. No force
// bypasses the chain. In each tick it checks the numbers, meters the energy and detects
// oscillations. It computes the force by the wall law and adds the dynamic force. Then it fades the
// force, limits its magnitude (peak, heat, energy tank) and its step, and updates trust.
// client/haptics/safety/README.md has all eleven steps, their laws and their constants.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <cstdint>

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/safety/contact_fade.hpp"
#include "client/haptics/safety/discontinuity_account.hpp"
#include "client/haptics/safety/oscillation_detector.hpp"
#include "client/haptics/safety/passivity_observer.hpp"
#include "client/haptics/safety/safety_action.hpp"
#include "client/haptics/safety/step_limit.hpp"
#include "client/haptics/safety/thermal_budget.hpp"
#include "client/haptics/safety/trust.hpp"
#include "client/haptics/safety/wall_law.hpp"

namespace hapticast::client {

/// One switch for each optional step of the chain: false omits the step, so that its effect can be
/// measured. Only the tests and hapticast-evaluate use it.
struct SafetyLinks {
  bool stiffness_limit = true;
  bool damping = true;
  bool passivity = true;
  bool tank = true;
  bool thermal = true;
  bool slew = true;
  bool fade = true;  ///< fade in, fade out and release ramp of the force
  bool arming = true;
  bool oscillation_detector = true;
  bool trust = true;
};

/// Input of one tick. All vectors are in the device frame, and lengths are in device mm.
struct SafetyInput {
  // The HIP as the device measured it.
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  /// Predicted HIP, delay + kPredictionMargin_ticks after the reading. The wall law uses it, and
  /// the contact below belongs to that instant.
  HipState ahead;
  bool measurement_jumped =
      false;  ///< the HIP was measured, but its position does not continue that of the last tick
  bool measurement_late = false;  ///< the HIP moved unseen for more than a tick, under one force
  bool scene_jumped = false;  ///< the stream caused a jump: a new epoch, or a surface that jumped
  /// The device does not answer; the halt that follows lasts until rearm().
  bool device_lost = false;
  // The contact.
  bool contact = false;
  Vec3 displacement_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  Vec3 surface_velocity_mm_s = Vec3::Zero();
  double scene_step_s = 1e-3;  ///< change of play time since the last tick
  /// Stiffness along the normal, divided by the stiffness along the displacement.
  double stiffness_factor = 1.0;
  double stiffness_N_mm = 0.5;
  double damping_Ns_m = 0.0;  ///< the author's damping, which is added to that of the wall law
  /// The scene does not continue that of the last tick: new epoch, connection or mapping.
  bool world_jumped = false;
  bool in_contact = false;  ///< a force may act: the scene is not stale, and the device is in use
  Vec3 dynamic_N = Vec3::Zero();
  /// The part of dynamic_N that is virtual inertia. The energy meters add its work to that of the
  /// wall.
  Vec3 inertia_N = Vec3::Zero();
  /// False: dynamic_N is not usable in this tick, and the dynamic force fades out.
  bool dynamic_valid = false;
  bool implausible = false;  ///< the plausibility bounds reduced the dynamic force
};

struct SafetyOutput {
  Vec3 force_N = Vec3::Zero();          ///< force for the device
  Vec3 static_force_N = Vec3::Zero();   ///< force of the wall law, before the limits
  Vec3 dynamic_force_N = Vec3::Zero();  ///< dynamic force after its fade
  double penetration_mm = 0.0;          ///< length of the displacement in use, device mm
  bool contact = false;
  /// A number was not finite or too large, so the chain used the last valid geometry.
  bool not_finite = false;
  bool too_far = false;     ///< the displacement is finite, but longer than the reach of any device
  bool trust_lost = false;  ///< trust was lost in this tick
  bool latency_alarm = false;  ///< the oscillation detector raised its alarm in this tick
  double step_excess_N = 0.0;  ///< step of the force beyond the slew limit; must be 0
  std::uint32_t safety_actions = 0;
};

/// The safety chain of one device. Its state connects the ticks, so step() has to run once in every
/// tick.
class SafetyChain {
 public:
  /// Copies the limits out of `profile`. The object does not need `profile` afterwards.
  explicit SafetyChain(const DeviceProfile& profile, const SafetyLinks& links = {}) noexcept;

  /// Runs all steps of the chain for one tick. Returns the force for the device, and a report of
  /// the actions of the chain.
  SafetyOutput step(const SafetyInput& input) noexcept;
  /// Returns true if the force of the last tick was not zero.
  [[nodiscard]] bool acts() const noexcept { return last_.force_N != Vec3::Zero(); }
  /// Returns the delay in use: the number of ticks from the reading of a position to the begin of
  /// its force. It is the profile's value. After an alarm of the oscillation detection it is one
  /// tick more.
  [[nodiscard]] int delayTicks() const noexcept { return delay_ticks_; }
  /// Returns the stiffness (N/mm) of the wall at the last contact, along its normal.
  [[nodiscard]] double wall_N_mm() const noexcept { return wall_N_mm_; }
  /// Ends a halt: the force then fades in from zero. The owner calls it on request of the user or
  /// of RearmPolicy. A halt follows the loss of the device, a loss of trust, stop() or
  /// awaitConfirmation().
  void rearm() noexcept {
    if (halt_ == Halt::kTrustLost) trust_.renew();
    stop_requested_ = false;
    halt_ = Halt::kNone;
    fade_.restart();
  }
  /// Ramps the force to zero. It remains zero until rearm().
  void stop() noexcept { stop_requested_ = true; }
  /// Halts the force from the first tick until rearm(). Call it for a device that was detected
  /// automatically, because the user has not confirmed it yet.
  void awaitConfirmation() noexcept { halt_ = Halt::kUnconfirmed; }
  /// Returns the cause of the present halt, or Halt::kNone.
  [[nodiscard]] Halt halt() const noexcept { return halt_; }
  /// Returns the safety action that contributed most to the loss of trust.
  [[nodiscard]] SafetyAction findDistrusted() const noexcept { return trust_.findMostFrequent(); }
  /// Call it at a new connection. It sets the delay back to the profile's value, as soon as there
  /// is no contact and no force.
  void newConnection() noexcept { forget_delay_ = delay_ticks_ != profile_delay_ticks_; }
  /// Returns Trust::score(): the number of ticks in which the stream caused a safety action. Trust
  /// is lost at Trust::kMost_ticks.
  [[nodiscard]] double trustScore() const noexcept { return trust_.score(); }
  /// Returns the work of the force since the start, by its cause.
  [[nodiscard]] const PortWork& work() const noexcept { return ports_.work(); }

 private:
  struct Geometry {
    bool contact = false;
    Vec3 displacement_mm = Vec3::Zero();
    double size_mm = 0.0;  // |displacement|
    Vec3 normal = Vec3::UnitZ();
    Vec3 surface_velocity_mm_s = Vec3::Zero();
    Vec3 surface_step_mm = Vec3::Zero();
    double stiffness_factor = 1.0;
    double stiffness_N_mm = 0.0;  // K_r
    double damping_Ns_m = 0.0;    // along the normal
  };

  void setDelay(int delay_ticks) noexcept;
  void forgetDelay() noexcept;
  bool halts(const SafetyInput& input, SafetyOutput& out) noexcept;
  Geometry plausible(const SafetyInput& input, SafetyOutput& out) noexcept;
  void material(const SafetyInput& input, Geometry& geometry, SafetyOutput& out) noexcept;
  double payStiffening(const SafetyInput& input, const Geometry& geometry) noexcept;
  Geometry holdGeometry(const Vec3& ahead_mm) const noexcept;
  bool jumped(const SafetyInput& input, const Geometry& geometry) const noexcept;
  StepState computeState(const SafetyInput& input, const Geometry& geometry,
                         bool not_finite) noexcept;
  void meter(const SafetyInput& input, StepState& now, const Geometry& geometry, bool jump,
             SafetyOutput& out) noexcept;
  Vec3 wallForce(const StepState& now, const Geometry& geometry, SafetyOutput& out) const noexcept;
  Vec3 dynamicForce(const SafetyInput& input, const Geometry& geometry, SafetyOutput& out) noexcept;
  void limitForce(const SafetyInput& input, FadeTick tick, StepState& now, const Geometry& geometry,
                  SafetyOutput& out) noexcept;
  void fadeAndArm(const SafetyInput& input, FadeTick tick, const StepState& now,
                  const Geometry& geometry, SafetyOutput& out) noexcept;
  double clampFactor(const Vec3& force_N, SafetyOutput& out) const noexcept;
  Vec3 limitStep(StepState& now, const Vec3& static_N, bool measurement_jumped,
                 SafetyOutput& out) noexcept;
  void countTrust(std::uint32_t safety_actions, bool scene_jumped) noexcept;
  double tankFactor(const Vec3& force_N, SafetyOutput& out) const noexcept;

  SafetyLinks links_;
  double peak_N_, mass_kg_;
  int profile_delay_ticks_;
  int delay_ticks_ = 0;
  double wall_N_mm_;
  double limit_N_;  // largest force in this tick, by the thermal budget and the peak
  double stiffness_limit_N_mm_ = 0.0, damping_limit_Ns_m_ = 0.0;
  DamperLimit damper_;
  StepLimit steps_;
  CountedMotion moved_;
  SurfaceHistory surface_;
  PassivityObserver ports_;
  DiscontinuityAccount account_;
  ContactFade fade_;
  EnergyTank tank_;
  ThermalBudget thermal_;
  OscillationDetector watch_;
  BounceDetector bounces_;
  Trust trust_;
  bool forget_delay_ = false;
  StepState last_;
  Geometry geometry_;  // of the last tick
  bool stop_requested_ = false;
  Halt halt_ = Halt::kNone;  // cause of the present halt, which lasts until rearm()
  double dynamic_fade_ = 0.0;
  Vec3 dynamic_N_ = Vec3::Zero();  // last valid dynamic force
  Vec3 inertia_N_ = Vec3::Zero();  // share of the inertia in dynamic_N_
  Vec3 static_N_ = Vec3::Zero();   // share of wall and inertia in the last force
  Vec3 wanted_N_ = Vec3::Zero();   // force of the last tick before the slew limit
  bool stream_stepped_ = false;    // the slew limit slowed a step that no hand can cause
};

}  // namespace hapticast::client
