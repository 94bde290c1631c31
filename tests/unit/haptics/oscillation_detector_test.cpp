// SPDX-License-Identifier: MIT
// The oscillation detector separates an unstable loop from a moving hand or surface.
#include "client/haptics/safety/oscillation_detector.hpp"

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
  OscillationDetector detector(kCount_mm);
  const auto counted = [&](int i) { return std::round(tip_mm(i) / kCount_mm) * kCount_mm; };
  int count = 0;
  for (int i = 1; i <= ticks; ++i) {
    count += detector.detectsAlarm(counted(i) - counted(i - 1), surface_mm(i) - surface_mm(i - 1),
                                   acts(i));
  }
  return count;
}
std::function<double(int)> wave(double amplitude_mm, double frequency_Hz, double growth_1_s = 0.0) {
  return [=](int i) {
    const double t_s = i * 1e-3;
    return amplitude_mm * std::exp(growth_1_s * t_s) * std::sin(2.0 * M_PI * frequency_Hz * t_s);
  };
}

TEST(OscillationDetector, DetectsALastingOrGrowingSwing) {
  for (const double frequency_Hz : {18.0, 30.0, 60.0, 100.0}) {
    EXPECT_GE(alarms(1000, wave(0.5, frequency_Hz)), 1) << frequency_Hz;
    EXPECT_GE(alarms(1000, wave(0.05, frequency_Hz, 5.0)), 1) << frequency_Hz;
  }
  EXPECT_EQ(alarms(190, wave(0.5, 30.0)), 0);  // fewer than twelve reversals
  EXPECT_EQ(alarms(260, wave(0.5, 30.0)), 1);
}

TEST(OscillationDetector, LeavesAHandAlone) {
  EXPECT_EQ(alarms(10'000, wave(2.0, 14.0)), 0);                // tremor
  EXPECT_EQ(alarms(10'000, wave(0.08, 60.0)), 0);               // less than three counts
  EXPECT_EQ(alarms(10'000, wave(3.0, 30.0, -8.0)), 0);          // rings down after an impact
  EXPECT_EQ(alarms(10'000, [](int i) { return 0.1 * i; }), 0);  // a reach
  EXPECT_EQ(alarms(10'000, [](int) { return 0.0; }), 0);
}

TEST(OscillationDetector, LeavesASwingingSurfaceAlone) {
  EXPECT_EQ(alarms(5000, wave(0.5, 30.0), wave(0.5, 30.0)), 0);
  EXPECT_EQ(alarms(5000, wave(0.5, 30.0), wave(0.3, 30.0)), 0);
  EXPECT_GE(alarms(5000, wave(0.5, 30.0), wave(0.2, 30.0)), 1);  // less than half of it
}

TEST(OscillationDetector, IsActiveOnlyWhileAForceActs) {
  EXPECT_EQ(alarms(5000, wave(0.5, 30.0), wave(0.0, 1.0), [](int) { return false; }), 0);
  // A tip that bounces is without a force for a part of each swing.
  EXPECT_GE(alarms(5000, wave(0.5, 30.0), wave(0.0, 1.0), [](int i) { return i % 33 < 10; }), 1);
}

struct Bounces {
  int contact_ticks = 16;
  double in_mm_s = 300.0;
  double share = 1.0;  // of the speed, given back
  int flight_ticks = 50;
  double surface_mm_s = 0.0;
  bool acts = true;
  double stiffness_N_mm = 2.0;
};

/// Alarms in ten contacts with a flight between them.
int bounceAlarms(const Bounces& what) {
  BounceDetector detector(0.045);
  int count = 0;
  const auto tick = [&](double tip_mm_s, bool contact) {
    const Vec3 normal = contact ? Vec3::UnitX() : Vec3::UnitZ();  // none without contact
    const double surface_mm_s = contact ? what.surface_mm_s : 0.0;
    count += detector.detectsAlarm(
        {(tip_mm_s + what.surface_mm_s) * Vec3::UnitX(), surface_mm_s * Vec3::UnitX(), normal,
         contact ? what.stiffness_N_mm : 0.0, contact, what.acts, false},
        1);
  };
  const double out_mm_s = what.share * what.in_mm_s;
  for (int bounce = 0; bounce < 10; ++bounce) {
    for (int i = 0; i < what.contact_ticks; ++i) {
      tick(i < what.contact_ticks / 2 ? -what.in_mm_s : out_mm_s, true);
    }
    for (int i = 0; i < what.flight_ticks; ++i) {
      tick(i < what.flight_ticks / 2 ? out_mm_s : -what.in_mm_s, false);
    }
  }
  return count;
}

TEST(BounceDetector, DetectsATipThatIsThrownBackAsFastAsItCame) {
  EXPECT_EQ(bounceAlarms({.share = 0.95}), 2);  // of nine that are judged, three and one between
  EXPECT_EQ(bounceAlarms({.share = 1.3, .flight_ticks = 200}), 2);
  EXPECT_EQ(bounceAlarms({.surface_mm_s = 100.0}), 2);
}

TEST(BounceDetector, LeavesHandsAndDampedBouncesAlone) {
  EXPECT_EQ(bounceAlarms({.share = 0.8}), 0);           // a wall that takes its share
  EXPECT_EQ(bounceAlarms({.contact_ticks = 45}), 0);    // a hand's mass stays longer
  EXPECT_EQ(bounceAlarms({.flight_ticks = 300}), 0);    // taps, one by one
  EXPECT_EQ(bounceAlarms({.flight_ticks = 8}), 0);      // brushes the edge
  EXPECT_EQ(bounceAlarms({.in_mm_s = 60.0}), 0);        // a count
  EXPECT_EQ(bounceAlarms({.surface_mm_s = 200.0}), 0);  // the surface strikes
  EXPECT_EQ(bounceAlarms({.acts = false}), 0);          // no force acts
  EXPECT_EQ(bounceAlarms({.contact_ticks = 300, .stiffness_N_mm = 0.0}), 0);
}

}  // namespace
}  // namespace hapticast::client
