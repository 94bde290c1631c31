// SPDX-License-Identifier: MIT
// What the latency watch takes for a loop that swings, and what for a hand or a surface.
#include "client/haptics/safety/latency_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace hapticast::client {
namespace {

constexpr double kCount_mm = 0.055;

/// Alarms within `ticks` of a tip and a surface at these places (quantised like a device's).
int alarms(
    int ticks, const std::function<double(int)>& tip_mm,
    const std::function<double(int)>& surface_mm = [](int) { return 0.0; },
    const std::function<bool(int)>& acts = [](int) { return true; }) {
  LatencyWatch watch(kCount_mm);
  const auto counted = [&](int i) { return std::round(tip_mm(i) / kCount_mm) * kCount_mm; };
  int count = 0;
  for (int i = 1; i <= ticks; ++i) {
    count += watch.alarmed(counted(i) - counted(i - 1), surface_mm(i) - surface_mm(i - 1), acts(i));
  }
  return count;
}
std::function<double(int)> wave(double amplitude_mm, double frequency_Hz, double growth_1_s = 0.0) {
  return [=](int i) {
    const double t_s = i * 1e-3;
    return amplitude_mm * std::exp(growth_1_s * t_s) * std::sin(2.0 * M_PI * frequency_Hz * t_s);
  };
}

TEST(LatencyWatch, SeesALastingOrGrowingSwing) {
  for (const double frequency_Hz : {15.0, 30.0, 60.0, 100.0}) {
    EXPECT_GE(alarms(1000, wave(0.5, frequency_Hz)), 1) << frequency_Hz;
    EXPECT_GE(alarms(1000, wave(0.05, frequency_Hz, 5.0)), 1) << frequency_Hz;
  }
  EXPECT_EQ(alarms(120, wave(0.5, 30.0)), 0);  // fewer than eight reversals
  EXPECT_EQ(alarms(200, wave(0.5, 30.0)), 1);
}

TEST(LatencyWatch, LeavesAHandAlone) {
  EXPECT_EQ(alarms(10'000, wave(2.0, 10.0)), 0);                // tremor
  EXPECT_EQ(alarms(10'000, wave(0.08, 60.0)), 0);               // less than three counts
  EXPECT_EQ(alarms(10'000, wave(3.0, 30.0, -8.0)), 0);          // rings down after an impact
  EXPECT_EQ(alarms(10'000, [](int i) { return 0.1 * i; }), 0);  // a reach
  EXPECT_EQ(alarms(10'000, [](int) { return 0.0; }), 0);
}

TEST(LatencyWatch, LeavesASwingingSurfaceAlone) {
  EXPECT_EQ(alarms(5000, wave(0.5, 30.0), wave(0.5, 30.0)), 0);
  EXPECT_EQ(alarms(5000, wave(0.5, 30.0), wave(0.3, 30.0)), 0);
  EXPECT_GE(alarms(5000, wave(0.5, 30.0), wave(0.2, 30.0)), 1);  // less than half of it
}

TEST(LatencyWatch, WatchesOnlyWhileAForceActs) {
  EXPECT_EQ(alarms(5000, wave(0.5, 30.0), wave(0.0, 1.0), [](int) { return false; }), 0);
  // A tip that bounces is without a force for a part of each swing.
  EXPECT_GE(alarms(5000, wave(0.5, 30.0), wave(0.0, 1.0), [](int i) { return i % 33 < 10; }), 1);
}

}  // namespace
}  // namespace hapticast::client
