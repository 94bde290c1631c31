// SPDX-License-Identifier: MIT
// Small steps that both halves of the proxy take. Inside client/haptics only. Real-time room.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/relief/height_field.hpp"

namespace hapticast::client {

constexpr double kLookAhead_px = 0.5;  // sub-step of flight: no 1-px feature is skipped
constexpr double kOutside_mm = 1e-3;   // a proxy at a wall stays this far outside

inline Vec2 limited(const Vec2& step_mm, double longest_mm) noexcept {
  const double length_mm = step_mm.norm();
  return length_mm > longest_mm ? Vec2(step_mm * (longest_mm / length_mm)) : step_mm;
}

/// Newton step to kOutside_mm outside the edge.
inline Vec2 stepToEdge(const EdgeSample& edge) noexcept {
  return -edge.gradient *
         ((edge.distance_mm + kOutside_mm) / std::max(0.25, edge.gradient.squaredNorm()));
}

/// Where a function crosses zero: at t = low it is not positive, at t = high it is.
struct Bracket {
  double low, low_value, high, high_value;

  [[nodiscard]] double secant() const noexcept {
    const double span = high_value - low_value;
    return span > 0.0 ? std::clamp(low - low_value * (high - low) / span, low, high) : high;
  }
  void push(double t, double value) noexcept {
    (value > 0.0 ? high : low) = t;
    (value > 0.0 ? high_value : low_value) = value;
  }
};

}  // namespace hapticast::client
