// SPDX-License-Identifier: MIT
// Rate limiter for a parameter of a material (stiffness, damping, friction). In contact it spreads
// a change of the parameter over 0.3 s. So a stream can neither strike the hand nor pump energy
// with the parameter.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "client/haptics/user_controls.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Limits how fast one parameter changes.
class ParameterRateLimiter {
 public:
  /// Returns the value to use in this tick for the requested value `wanted`. If `in_contact` is
  /// false, the result is `wanted`. If `wanted` is not finite, the result is `wanted` too, and the
  /// state does not change.
  double step(double wanted, bool in_contact) noexcept {
    if (!std::isfinite(wanted)) return wanted;  // the safety chain rejects it
    if (!in_contact) value_ = goal_ = wanted;
    if (wanted != goal_) {
      goal_ = wanted;
      step_ = std::abs(goal_ - value_) * (kTick_s / kChange_s);
    }
    value_ = std::clamp(goal_, value_ - step_, value_ + step_);
    return value_;
  }

 private:
  static constexpr double kChange_s = 0.3;  // a choice: too slow to drive a hand
  double value_ = 0.0;
  double goal_ = 0.0;
  double step_ = 0.0;  // per tick
};

// Applies the user's controls to the force. In contact, gains change slowly (ParameterRateLimiter).
// A change of the method or of the surface model cannot be gradual, so the force then restarts from
// zero.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).

/// The gains and the choices of the user in the present tick.
class UserForceMix {
 public:
  UserForceMix(Method method, SurfaceKind surface) noexcept
      : own_method_(method), own_surface_(surface), method_(method), surface_(surface) {}

  /// Applies the user's controls of this tick. Returns true if the method or the surface model has
  /// changed, or if the static force was switched on again. The caller then has to fade in the
  /// force from zero.
  bool update(const UserControls& user) noexcept {
    const Method method = user.method.value_or(own_method_);
    const SurfaceKind surface = user.surface.value_or(own_surface_);
    const bool comes_back = user.static_on && !static_on_;
    const bool changed = method != method_ || surface != surface_ || comes_back;
    method_ = method;
    surface_ = surface;
    static_on_ = user.static_on;
    const double force = within(user.force_factor, 0.0, 1.0);
    wall_ = static_on_ ? force : 0.0;
    dynamic_ = user.dynamic_on ? force : 0.0;
    stiffness_ = within(user.stiffness_factor, 0.1, 3.0);
    friction_ = user.friction;
    if (friction_) friction_ = within(*friction_, 0.0, 1.0);
    return changed;
  }
  /// Returns the gain of the dynamic force in this tick, 0..1.
  double dynamicGain(bool in_contact) noexcept { return dynamic_ramp_.step(dynamic_, in_contact); }

  [[nodiscard]] Method method() const noexcept { return method_; }
  [[nodiscard]] SurfaceKind surface() const noexcept { return surface_; }
  /// Returns the gain of the wall's spring and damper, 0..1.
  [[nodiscard]] double staticGain() const noexcept { return wall_; }
  /// Returns the factor by which the requested stiffness is multiplied, 0.1..3.
  [[nodiscard]] double stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] const std::optional<double>& friction() const noexcept { return friction_; }

 private:
  /// Clamps `value`; NaN counts as `low`.
  static double within(double value, double low, double high) noexcept {
    return value >= low ? std::min(value, high) : low;
  }

  Method own_method_;
  SurfaceKind own_surface_;
  Method method_;
  SurfaceKind surface_;
  bool static_on_ = true;
  double wall_ = 1.0;
  double dynamic_ = 1.0;
  double stiffness_ = 1.0;
  std::optional<double> friction_;
  ParameterRateLimiter dynamic_ramp_;
};

}  // namespace hapticast::client
