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
  for (const double frequency_Hz : {18.0, 30.0, 60.0, 100.0}) {
    EXPECT_GE(alarms(1000, wave(0.5, frequency_Hz)), 1) << frequency_Hz;
    EXPECT_GE(alarms(1000, wave(0.05, frequency_Hz, 5.0)), 1) << frequency_Hz;
  }
  EXPECT_EQ(alarms(190, wave(0.5, 30.0)), 0);  // fewer than twelve reversals
  EXPECT_EQ(alarms(260, wave(0.5, 30.0)), 1);
}

TEST(LatencyWatch, LeavesAHandAlone) {
  EXPECT_EQ(alarms(10'000, wave(2.0, 14.0)), 0);                // tremor
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

/// Alarms in ten contacts of `contact_ticks`, each entered at `in_mm_s` and left with `share` of
/// that, with a flight of `flight_ticks` between them.
int bounceAlarms(int contact_ticks, double in_mm_s, double share, int flight_ticks) {
  BounceWatch watch(0.045);
  int count = 0;
  for (int bounce = 0; bounce < 10; ++bounce) {
    for (int i = 0; i < contact_ticks; ++i) {
      const double speed_mm_s = i < contact_ticks / 2 ? -in_mm_s : share * in_mm_s;
      count += watch.alarmed(speed_mm_s, true, 2.0, 1);
    }
    for (int i = 0; i < flight_ticks; ++i) {
      count += watch.alarmed(i < flight_ticks / 2 ? share * in_mm_s : -in_mm_s, false, 0.0, 1);
    }
  }
  return count;
}

TEST(BounceWatch, SeesATipThatIsThrownBackAsFastAsItCame) {
  EXPECT_EQ(bounceAlarms(16, 300.0, 0.95, 50),
            2);  // of nine that are judged, three each and one between
  EXPECT_EQ(bounceAlarms(16, 300.0, 1.3, 200), 2);
}

TEST(BounceWatch, LeavesHandsAndDampedBouncesAlone) {
  EXPECT_EQ(bounceAlarms(16, 300.0, 0.8, 50), 0);   // a wall that takes its share
  EXPECT_EQ(bounceAlarms(45, 300.0, 1.0, 50), 0);   // a hand's mass stays longer
  EXPECT_EQ(bounceAlarms(16, 300.0, 1.0, 300), 0);  // taps, one by one
  EXPECT_EQ(bounceAlarms(16, 300.0, 1.0, 8), 0);    // brushes the edge
  EXPECT_EQ(bounceAlarms(16, 60.0, 1.0, 50), 0);    // a count
}

}  // namespace
}  // namespace hapticast::client
