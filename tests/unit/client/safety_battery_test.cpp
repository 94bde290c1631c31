// SPDX-License-Identifier: MIT
// Stability: what a hand, or none, feels at rest after an impact.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/unit/client/rig.hpp"

namespace hapticast::client {
namespace {

// --------------------------------------------------------------------------------------

struct Hold {
  double low = 1e9;
  double high = -1e9;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  [[nodiscard]] double counts(double count_mm) const { return (high - low) / count_mm; }
};

/// Approach at 0.2 m/s, hold 1 N, press slowly to 2.5 N, hold, release. Worst peak-to-peak of the
/// holds in counts.
double battery(double stiffness_N_mm, int delay_ticks, const Hand& hand, double friction_N) {
  DeviceProfile profile = omni(stiffness_N_mm, delay_ticks, friction_N);
  profile.peak_N = profile.continuous_N = 8.0;  // the clamp of the notes' battery, cold motors
  Rig rig(profile, profile, hand);
  const bool free = hand.stiffness_N_m == 0.0;
  const double soft_mm = free ? 0.0 : 1e3 / hand.stiffness_N_m;
  const double stretch_mm = soft_mm + 1.0 / std::min(stiffness_N_mm, stiffnessLimit_N_mm(profile));
  rig.device.reset({0.0, 0.0, 20.0}, Vec3::Zero());
  rig.run(250);
  if (free) rig.device.reset({0.0, 0.0, 20.0}, {0.0, 0.0, -200.0});
  const auto want = [&](double force_N, double from_mm) {
    if (free)
      rig.device.setPush({0.0, 0.0, -force_N});
    else
      rig.device.setTarget({0.0, 0.0, std::min(from_mm, 20.0) - force_N * stretch_mm});
  };
  for (int i = 0; i < 100; ++i) {  // the impact
    if (!free) want(0.0, 20.0 - 0.2 * i);
    rig.step();
  }
  Hold first;
  for (int i = 0; i < 3000; ++i) {
    want(std::min(1.0, i / 200.0), 0.0);
    rig.step();
    if (i >= 2000) first.add(rig.device.truePosition_mm().z());
  }
  for (int i = 0; i < 1500; ++i) {
    want(1.0 + i / 1000.0, 0.0);
    rig.step();
  }
  Hold second;
  for (int i = 0; i < 2000; ++i) {
    rig.step();
    if (i >= 1000) second.add(rig.device.truePosition_mm().z());
  }
  want(-0.5, 0.0);
  rig.run(500);
  EXPECT_EQ(rig.max_excess_N, 0.0);
  EXPECT_LE(rig.max_outer_excess_N, 1e-9);
  EXPECT_EQ(rig.out.force_N, Vec3(Vec3::Zero())) << "not released";
  return std::max(first.counts(0.055), second.counts(0.055));
}

TEST(SafetyBattery, BatteryIsQuietUpToTheStiffestWall) {
  const struct {
    const char* name;
    Hand hand;
  } hands[] = {{"light", Hand::light()},
               {"light-grip", Hand::lightGrip()},
               {"firm", Hand::firm()},
               {"firm-grip", Hand::firmGrip()},
               {"none", Hand::none()}};
  for (int d = 0; d <= 2; ++d) {
    for (const double k : {0.5, 1.0, 2.0, 5.0, 10.0}) {
      if (k > 1.01 * stiffnessLimit_N_mm(omni(k, d)) && k > 2.0) continue;
      for (const auto& [name, hand] : hands) {
        const double rough = battery(k, d, hand, 0.0);
        const double rubbed = battery(k, d, hand, 0.05);
        std::printf("battery d %d K %4.1f %-10s residual %.2f counts, with friction %.2f\n", d, k,
                    name, rough, rubbed);
        EXPECT_LE(rough, 2.0) << name << " K " << k << " d " << d;
        EXPECT_LE(rubbed, 2.0) << name << " K " << k << " d " << d;
      }
    }
  }
}

TEST(SafetyBattery, BatterySeesAWallThatIsTooStiffForItsDelay) {
  // The test above can fail: told no delay, with two ticks of it, a free device runs away at 5
  // N/mm.
  DeviceProfile told = omni(5.0, 0);
  told.peak_N = 8.0;
  DeviceProfile real = told;
  real.delay_ticks = 2;
  Rig rig(told, real, Hand::none());
  rig.run(250);
  rig.device.reset({0.0, 0.0, 5.0}, {0.0, 0.0, -200.0});
  rig.device.setPush({0.0, 0.0, -1.0});
  rig.run(3000);
  Hold hold;
  for (int i = 0; i < 500; ++i) {
    rig.step();
    hold.add(rig.device.truePosition_mm().z());
  }
  EXPECT_GT(hold.counts(0.055), 10.0);
}

}  // namespace
}  // namespace hapticast::client
