// SPDX-License-Identifier: MIT
// Applies the user's controls to the force. In contact, gains change slowly (ParameterRateLimiter).
// A change of the method, of the surface model or of the mass restarts the force from zero.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <algorithm>
#include <optional>

#include "client/haptics/parameter_rate_limiter.hpp"
#include "client/haptics/user_controls.hpp"

namespace hapticast::client {

/// The gains and the choices of the user in the present tick.
class UserForceMix {
 public:
  /// `method` and `surface` hold as long as the user selects no others.
  UserForceMix(Method method, SurfaceKind surface) noexcept
      : own_method_(method), own_surface_(surface), method_(method), surface_(surface) {}

  /// Applies the user's controls of this tick. Returns true if the method, the surface model or
  /// the mass has changed, or if the static force was switched on again. The caller then has to
  /// fade in the force from zero.
  bool update(const UserControls& user) noexcept {
    const Method method = user.method.value_or(own_method_);
    const SurfaceKind surface = user.surface.value_or(own_surface_);
    const bool comes_back = user.static_on && !static_on_;
    const bool changed =
        method != method_ || surface != surface_ || comes_back || user.mass_kg != mass_kg_;
    mass_kg_ = user.mass_kg;
    method_ = method;
    surface_ = surface;
    static_on_ = user.static_on;
    const double force = clampWithin(user.force_factor, 0.0, 1.0);
    wall_ = static_on_ ? force : 0.0;
    dynamic_ = user.dynamic_on ? force : 0.0;
    stiffness_ = clampWithin(user.stiffness_factor, 0.1, 3.0);
    friction_ = user.friction;
    if (friction_) friction_ = clampWithin(*friction_, 0.0, 1.0);
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
  /// Returns the mass that replaces the author's one, kg.
  [[nodiscard]] const std::optional<double>& mass_kg() const noexcept { return mass_kg_; }

 private:
  /// Clamps `value`; NaN counts as `low`.
  static double clampWithin(double value, double low, double high) noexcept {
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
  std::optional<double> mass_kg_;
  ParameterRateLimiter dynamic_ramp_;
};

}  // namespace hapticast::client
