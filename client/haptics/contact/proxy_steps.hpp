// SPDX-License-Identifier: MIT
// Steps that the free motion and the contact motion of the proxy share. For client/haptics/contact
// only.
// Thread: loop, real-time (rules: client/haptics/README.md, section 1).
#pragma once

#include <algorithm>
#include <cmath>

#include "common/relief/height_field.hpp"

namespace hapticast::client {

constexpr double kLookAhead_px = 0.5;  // sub-step of a march: skips no feature of 1 px (prototype)
constexpr double kOutside_mm = 1e-3;   // distance of a proxy at a wall from the edge, outside

/// Returns `step_mm`, shortened to at most `longest_mm`.
inline Vec2 limited(const Vec2& step_mm, double longest_mm) noexcept {
  const double length_mm = step_mm.norm();
  return length_mm > longest_mm ? Vec2(step_mm * (longest_mm / length_mm)) : step_mm;
}

/// Returns the Newton step to the point kOutside_mm outside the edge.
inline Vec2 stepToEdge(const EdgeSample& edge) noexcept {
  return -edge.gradient *
         ((edge.distance_mm + kOutside_mm) / std::max(0.25, edge.gradient.squaredNorm()));
}

/// Bracketed secant method for a zero crossing. Invariant: the value is not positive at `low` and
/// positive at `high`.
struct Bracket {
  double low, low_value, high, high_value;

  /// Next argument to evaluate, within [low, high].
  [[nodiscard]] double secant() const noexcept {
    const double span = high_value - low_value;
    return span > 0.0 ? std::clamp(low - low_value * (high - low) / span, low, high) : high;
  }
  /// Replaces one end of the bracket by the value at `t`.
  void push(double t, double value) noexcept {
    (value > 0.0 ? high : low) = t;
    (value > 0.0 ? high_value : low_value) = value;
  }
};

}  // namespace hapticast::client
