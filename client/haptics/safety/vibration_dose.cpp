// SPDX-License-Identifier: MIT
#include "client/haptics/safety/vibration_dose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
constexpr double kMemory_s = 60.0;
constexpr double kLowest_1_s = 2.0 * std::numbers::pi * 6.3;
constexpr double kHighest_1_s = 2.0 * std::numbers::pi * 16.0;
}  // namespace

void VibrationDose::add(double surface_mm_s, double hip_mm_s) noexcept {
  const double most_mm_s = std::abs(hip_mm_s);
  const double speed_mm_s = std::clamp(surface_mm_s, -most_mm_s, most_mm_s);
  if (!std::isfinite(speed_mm_s)) return;
  slow_mm_s_ += kLowest_1_s * kTick_s * (speed_mm_s - slow_mm_s_);
  const double before_mm_s = smooth_mm_s_;
  smooth_mm_s_ += kHighest_1_s * kTick_s * (speed_mm_s - slow_mm_s_ - smooth_mm_s_);
  const double weighted_m_s2 = 1e-3 * (smooth_mm_s_ - before_mm_s) / kTick_s;
  square_m2_s4_ += kTick_s / kMemory_s * (weighted_m_s2 * weighted_m_s2 - square_m2_s4_);
}

double VibrationDose::rms_m_s2() const noexcept { return std::sqrt(square_m2_s4_); }

}  // namespace hapticast::client
