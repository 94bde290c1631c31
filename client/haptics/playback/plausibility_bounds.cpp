// SPDX-License-Identifier: MIT
#include "client/haptics/playback/plausibility_bounds.hpp"

#include <algorithm>
#include <cmath>

#include "client/haptics/playback/pose.hpp"

namespace hapticast::client {

namespace {

// Measured on honest streams (evaluate stability, part `honest`). A server smooths its statements
// over more frames than this code compares, so twice the largest change is plausible.
constexpr double kFactor = 2.0;
constexpr double kAccelerationFactor = 3.0;  // sum of both derivations, where frames are lost
constexpr double kImpactFactor = 1.5;
// Acceleration of a surface that changes its shape, beyond that of its body. Chosen: a hand's
// fingers.
constexpr double kDeforming_mm_s2 = 2000.0;
// Half of the shortest interval at the wire's limit of 240 frames/s; the other half covers jitter
// of the capture times. At an interval of a microsecond the smallest step would support any
// statement.
constexpr double kShortest_s = 0.5 / 240.0;

constexpr std::size_t kSteps = ObjectHistory::kFrames - 1;

double magnitude(double value) noexcept { return std::abs(value); }
double magnitude(const Vec3& value) noexcept { return value.norm(); }

/// The largest speed, change of speed, and rate of that change in the frames.
struct Largest {
  double speed = 0.0;
  double change = 0.0;
  double rate = 0.0;
};

/// Finds the largest values. `step(i)` is the motion from frame i to i+1. `rate(i)` is the speed
/// that frame i states; it counts up to twice the fastest step. Both are called for present frames
/// only.
template <class Value, class Step, class Rate>
Largest findLargest(const ObjectHistory& seen, Step step, Rate rate) noexcept {
  Largest most;
  const auto known = [&](std::size_t i) noexcept {
    return seen.object[i] != nullptr && seen.object[i + 1] != nullptr &&
           seen.interval_s[i] >= kShortest_s;
  };
  for (std::size_t i = 0; i < kSteps; ++i) {
    if (known(i)) most.speed = std::max(most.speed, magnitude(step(i)) / seen.interval_s[i]);
  }
  const auto plausible = [&](std::size_t i) noexcept -> Value {
    const Value streamed = rate(i);
    const double size = magnitude(streamed);
    const double limit = kFactor * most.speed;
    return size > limit ? Value(streamed * (limit / size)) : streamed;
  };
  const auto take = [&](double change, double time_s) noexcept {
    most.change = std::max(most.change, change);
    most.rate = std::max(most.rate, change / time_s);
  };
  for (std::size_t i = 0; i < kSteps; ++i) {
    if (!known(i)) continue;
    const Value changed = plausible(i + 1) - plausible(i);
    take(magnitude(changed), seen.interval_s[i]);
    if (i + 1 == kSteps || !known(i + 1)) continue;
    const Value turned = step(i + 1) / seen.interval_s[i + 1] - step(i) / seen.interval_s[i];
    take(magnitude(turned), 0.5 * (seen.interval_s[i] + seen.interval_s[i + 1]));
  }
  return most;
}

}  // namespace

PlausibilityBounds computePlausibilityBounds(const ObjectHistory& seen) noexcept {
  // A relief that is declared unchanged has not moved, whatever position the frame states.
  const auto moved = [&](std::size_t i) noexcept {
    return seen.object[i]->field != seen.object[i + 1]->field;
  };
  const auto motion = [&](std::size_t i) noexcept -> const Motion& {
    return seen.object[i]->motion;
  };
  const Largest path = findLargest<Vec3>(
      seen,
      [&](std::size_t i) noexcept -> Vec3 {
        if (!moved(i)) return Vec3::Zero();
        return motion(i + 1).position_mm - motion(i).position_mm;
      },
      [&](std::size_t i) noexcept -> Vec3 { return motion(i).velocity_mm_s; });
  const Largest turning = findLargest<double>(
      seen,
      [&](std::size_t i) noexcept {
        return moved(i) ? rotationBetween(motion(i), motion(i + 1)) : 0.0;
      },
      [&](std::size_t i) noexcept { return motion(i).angular_velocity_rad_s; });
  constexpr std::size_t kNow = ObjectHistory::kNow;
  const bool deforms =
      seen.object[kNow] != nullptr && seen.object[kNow + 1] != nullptr && moved(kNow);
  PlausibilityBounds plausibility;
  plausibility.acceleration_mm_s2 = kAccelerationFactor * path.rate;
  plausibility.grid_mm_s2 = deforms ? plausibility.acceleration_mm_s2 + kDeforming_mm_s2 : 0.0;
  plausibility.impact_mm_s = kImpactFactor * path.change;
  plausibility.turn_rad_s = kFactor * turning.speed;
  plausibility.turn_rate_rad_s2 = kFactor * turning.rate;
  return plausibility;
}

}  // namespace hapticast::client
