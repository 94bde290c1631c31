// SPDX-License-Identifier: MIT
// What the user's controls make of the force: weights that change slowly under the hand, and what
// has to begin from zero because no weight leads from one to the other. Real-time room.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "client/haptics/parameter_rate_limiter.hpp"
#include "client/haptics/user_controls.hpp"

namespace hapticast::client {

class UserForceMix {
 public:
  UserForceMix(Method method, SurfaceKind surface) noexcept
      : own_method_(method), own_surface_(surface), method_(method), surface_(surface) {}

  /// Takes over what the user wants now; whether the surface under the hand is another one, so that
  /// its force has to fade in from zero.
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
  /// Weight of the dynamic force in this tick.
  double dynamicGain(bool in_contact) noexcept { return dynamic_ramp_.step(dynamic_, in_contact); }

  [[nodiscard]] Method method() const noexcept { return method_; }
  [[nodiscard]] SurfaceKind surface() const noexcept { return surface_; }
  [[nodiscard]] double staticGain() const noexcept { return wall_; }      ///< of wall and damper
  [[nodiscard]] double stiffness() const noexcept { return stiffness_; }  ///< of what is asked for
  [[nodiscard]] const std::optional<double>& friction() const noexcept { return friction_; }

 private:
  /// A NaN counts as the lowest.
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
