// SPDX-License-Identifier: MIT
// The safety chain: from where the tip should be (geometry) and the dynamic force to the force a
// device may feel. Nothing reaches the device around it. Its steps in order, their laws and
// constants stand in client/haptics/README.md. Real-time room.
#pragma once

#include <cstdint>

#include "client/haptics/estimation/hip_observer.hpp"
#include "client/haptics/haptic_device.hpp"
#include "client/haptics/safety/oscillation_detector.hpp"
#include "client/haptics/safety/passivity_observer.hpp"
#include "client/haptics/safety/safety_action.hpp"
#include "client/haptics/safety/step_limit.hpp"
#include "client/haptics/safety/thermal_budget.hpp"
#include "client/haptics/safety/trust.hpp"
#include "client/haptics/safety/wall_law.hpp"

namespace hapticast::client {

/// The links that can be left out to show what each is there for. Only tests and evaluate do.
struct SafetyLinks {
  bool stiffness_limit = true;
  bool damping = true;
  bool passivity = true;
  bool tank = true;
  bool thermal = true;
  bool slew = true;
  bool fade = true;  ///< fade in, fade out, residue
  bool arming = true;
  bool latency_watch = true;
  bool trust = true;
};

/// Device frame, device mm.
struct SafetyInput {
  // The tip, by its counts.
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  HipState ahead;  ///< where this tick's force will find it: there the wall is touched
  bool measurement_jumped =
      false;                 ///< position and velocity are not connected with the last tick's
  bool device_lost = false;  ///< latched; only rearm() ends it
  // What it touches.
  bool contact = false;
  Vec3 displacement_mm = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
  Vec3 surface_velocity_mm_s = Vec3::Zero();
  double scene_step_s = 1e-3;     ///< time that the scene lived since the last tick
  double stiffness_factor = 1.0;  ///< |displacement| over depth along the normal
  double stiffness_N_mm = 0.5;
  double damping_Ns_m = 0.0;  ///< the author's, beyond what stability asks for
  bool world_jumped = false;  ///< epoch, connection, mapping
  bool in_contact = false;    ///< the scene is fresh enough to be felt
  Vec3 dynamic_N = Vec3::Zero();
  Vec3 inertia_N = Vec3::Zero();  ///< of the tip, in dynamic_N: the contact's own, as the wall is
  bool dynamic_valid = false;     ///< else the dynamic force fades out
  bool implausible = false;       ///< it was cut to what the stream's frames bear out
};

struct SafetyOutput {
  Vec3 force_N = Vec3::Zero();          ///< what goes to the device
  Vec3 static_force_N = Vec3::Zero();   ///< the wall law
  Vec3 dynamic_force_N = Vec3::Zero();  ///< after its fade
  double penetration_mm = 0.0;          ///< |displacement| used, device mm
  bool contact = false;
  bool not_finite = false;     ///< or too far: the last geometry was held
  bool too_far = false;        ///< a finite displacement that no device could make
  bool trust_lost = false;     ///< in this tick
  bool latency_alarm = false;  ///< raised in this tick: swings that the profile's delay cannot make
  double step_excess_N = 0.0;  ///< over StepLimit's: must be 0
  std::uint32_t interferences = 0;
};

class SafetyChain {
 public:
  /// Copies what it needs of the profile.
  explicit SafetyChain(const DeviceProfile& profile, const SafetyLinks& links = {}) noexcept;

  SafetyOutput step(const SafetyInput& input) noexcept;
  /// A force acts on the device (it did at the last tick).
  [[nodiscard]] bool acts() const noexcept { return last_.force_N != Vec3::Zero(); }
  /// Ticks between reading a position and the begin of its force, as far as is known.
  [[nodiscard]] int delayTicks() const noexcept { return delay_ticks_; }
  /// Stiffness along the normal of the wall that was touched last.
  [[nodiscard]] double wall_N_mm() const noexcept { return wall_N_mm_; }
  /// From outside, after a lost device came back, trust was lost or stop(): the force may return,
  /// from zero.
  void rearm() noexcept;
  /// Ramps the force to zero and keeps it there until rearm().
  void stop() noexcept { stop_requested_ = true; }
  /// There is no force until rearm(), from the first tick on.
  void awaitConfirmation() noexcept { halt_ = Halt::kUnconfirmed; }
  /// Why there is no force until somebody re-arms it.
  [[nodiscard]] Halt halt() const noexcept { return halt_; }
  /// Which interference cost most of the trust.
  [[nodiscard]] SafetyAction distrusted() const noexcept { return trust_.mostly(); }
  /// What the latency watch has learned is forgotten as soon as nothing is touched.
  void newConnection() noexcept { forget_delay_ = delay_ticks_ != profile_delay_ticks_; }
  /// Work of the force so far.
  [[nodiscard]] const PortWork& work() const noexcept { return ports_.work(); }

 private:
  struct Geometry {
    bool contact = false;
    Vec3 displacement_mm = Vec3::Zero();
    double size_mm = 0.0;  // of the displacement
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
  Geometry plausible(const SafetyInput& input, SafetyOutput& out) const noexcept;
  void material(const SafetyInput& input, Geometry& geometry, SafetyOutput& out) const noexcept;
  Geometry heldGeometry(const Vec3& ahead_mm) const noexcept;
  bool jumped(const SafetyInput& input, const Geometry& geometry) const noexcept;
  StepState computeState(const SafetyInput& input, const Geometry& geometry,
                         bool not_finite) const noexcept;
  void meter(const StepState& now, const Geometry& geometry, bool measurement_jumped, bool jump,
             SafetyOutput& out) noexcept;
  Vec3 wallForce(const StepState& now, const Geometry& geometry, SafetyOutput& out) const noexcept;
  Vec3 dynamicForce(const SafetyInput& input, const Geometry& geometry, SafetyOutput& out) noexcept;
  void fadeAndArm(bool jump, bool touchable, const Geometry& geometry, SafetyOutput& out) noexcept;
  double clampFactor(const Vec3& force_N, SafetyOutput& out) const noexcept;
  Vec3 limitStep(StepState& now, const Vec3& static_N, bool measurement_jumped,
                 SafetyOutput& out) const noexcept;
  double tankFactor(const Vec3& force_N, SafetyOutput& out) const noexcept;

  SafetyLinks links_;
  double peak_N_, residue_step_N_, mass_kg_;
  int profile_delay_ticks_;
  int delay_ticks_ = 0;
  double wall_N_mm_;
  double limit_N_;  // of the force in this tick: the motors' heat, the peak
  double stiffness_limit_N_mm_ = 0.0, damping_limit_Ns_m_ = 0.0;
  DamperLimit damper_;
  StepLimit steps_;
  PassivityObserver ports_;
  EnergyTank tank_;
  ThermalBudget thermal_;
  OscillationDetector watch_;
  BounceDetector bounces_;
  Trust trust_;
  bool forget_delay_ = false;
  StepState last_;
  Geometry geometry_;  // of the last tick
  bool stop_requested_ = false;
  Halt halt_ = Halt::kNone;  // until rearm()
  double fade_ = 0.0;        // 0..1, smoothed before use
  double dynamic_fade_ = 0.0;
  Vec3 dynamic_N_ = Vec3::Zero();  // last valid one
  Vec3 inertia_N_ = Vec3::Zero();  // in it
  Vec3 residue_N_ = Vec3::Zero();
  Vec3 residue_static_N_ = Vec3::Zero();  // of wall and inertia
  Vec3 static_N_ = Vec3::Zero();          // of wall and inertia, as sent last
  bool check_depth_ = true;               // the next touchable geometry decides whether we may arm
  bool blocked_ = false;                  // too deep after a jump
};

}  // namespace hapticast::client
