// SPDX-License-Identifier: MIT
// Extreme cases: no step of the force that the hand does not explain.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {
namespace {

// -----------------------------------------------------------------------------------------------

/// A light hand resting 5 mm into a wall (2 mm of it the tip), K 1 or 5, friction 0.05 N.
struct Extreme {
  explicit Extreme(double stiffness_N_mm, double target_mm = -5.0)
      : rig(omni(stiffness_N_mm, 1, 0.05), omni(stiffness_N_mm, 1, 0.05), Hand::light()) {
    rig.device.reset({0.0, 0.0, 10.0}, Vec3::Zero());
    rig.run(300);
    for (int i = 0; i < 600; ++i) {
      rig.device.setTarget({0.0, 0.0, 10.0 + (target_mm - 10.0) * std::min(1.0, i / 300.0)});
      rig.step();
    }
    rig.run(1000);
    rig.clear();
  }
  ~Extreme() {
    std::printf("%-46s K %.0f: step %.2f N, peak %.2f N, excess %g N\n", name.c_str(),
                rig.stiffness_N_mm, rig.max_step_N, rig.max_force_N, rig.max_excess_N);
    EXPECT_TRUE(rig.finite) << name;
    EXPECT_EQ(rig.max_excess_N, 0.0) << name;
    EXPECT_LE(rig.max_force_N, 3.3 + 1e-9) << name;
  }
  Extreme(const Extreme&) = delete;
  Extreme& operator=(const Extreme&) = delete;
  void raiseWall(double velocity_mm_s, int ticks) {
    rig.wall_velocity_mm_s = velocity_mm_s;
    for (int i = 0; i < ticks; ++i) {
      rig.wall_mm += velocity_mm_s * 1e-3;
      rig.step();
    }
    rig.wall_velocity_mm_s = 0.0;
  }
  ChainFixture rig;
  std::string name;
};

class SafetyExtremes : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Stiffness, SafetyExtremes, ::testing::Values(0.5, 1.0, 5.0));

TEST_P(SafetyExtremes, SurfaceAppearsFarAboveTheTip) {
  Extreme e(GetParam(), 5.0);
  e.name = "surface appears 30 mm above the tip";
  e.rig.wall_mm = 35.0;
  e.rig.run(1000);
  EXPECT_EQ(e.rig.max_force_N, 0.0);
  e.rig.wall_mm = 0.0;  // gone again: the hand is out, the force may return
  e.rig.run(300);
  e.rig.device.setTarget({0.0, 0.0, -5.0});
  e.rig.run(1000);
  EXPECT_GT(e.rig.out.force_N.z(), 0.5);
}

TEST_P(SafetyExtremes, SurfaceRisesThirtyMillimetresWithinAFrame) {
  Extreme e(GetParam());
  e.name = "30 mm rise within one frame of 40 ms";
  e.raiseWall(750.0, 40);
  e.rig.run(1000);
  EXPECT_GT(e.rig.max_force_N, 1.0);
}

TEST_P(SafetyExtremes, StallThenSurfaceHigher) {
  Extreme e(GetParam());
  e.name = "stall 0.5 s, then +20 mm";
  e.rig.touchable = false;
  e.rig.run(500);
  EXPECT_EQ(e.rig.out.force_N, Vec3(Vec3::Zero()));
  e.rig.touchable = true;
  e.rig.wall_mm += 20.0;
  e.rig.clear();
  e.rig.run(1000);
  EXPECT_EQ(e.rig.max_force_N, 0.0);  // too deep: unarmed
}

TEST_P(SafetyExtremes, ImpactPulse) {
  Extreme e(GetParam());
  e.name = "pulse of 3 N, 15 ms";
  for (int i = 0; i < 15; ++i) {
    e.rig.dynamic_N = {0.0, 0.0, 3.0 * std::sin(M_PI * (i + 0.5) / 15)};
    e.rig.step();
  }
  e.rig.dynamic_N.setZero();
  e.rig.run(500);
  EXPECT_GT(e.rig.max_force_N, 2.0);
}

TEST_P(SafetyExtremes, LateTicks) {
  for (const int ms : {3, 10, 200}) {
    Extreme e(GetParam());
    e.name = "late tick of " + std::to_string(ms) + " ms";
    e.rig.step(Duration(ms * 1'000'000LL));
    e.rig.run(500);
  }
}

TEST_P(SafetyExtremes, ClockJumpMovesTheSurface) {
  for (const double by_mm : {15.0, -15.0}) {
    Extreme e(GetParam());
    e.name = "clock jump, surface " + std::to_string(static_cast<int>(by_mm)) + " mm";
    e.rig.wall_mm += by_mm;
    e.rig.step();
    e.rig.run(1000);
  }
}

TEST_P(SafetyExtremes, TipAtTwoMetresPerSecond) {
  Extreme e(GetParam(), 20.0);
  e.name = "tip at 2 m/s into the wall";
  e.rig.device.reset({0.0, 0.0, 10.0}, {0.0, 0.0, -2000.0});
  e.rig.device.setTarget({0.0, 0.0, -5.0});
  e.rig.run(1000);
  EXPECT_GT(e.rig.max_force_N, 1.5);  // the tank pays for no more on the way out
}

TEST_P(SafetyExtremes, NanHeightsForFiveTicks) {
  Extreme e(GetParam());
  e.name = "NaN heights for 5 ticks";
  e.rig.nan_heights = true;
  e.rig.run(5);
  e.rig.nan_heights = false;
  e.rig.run(500);
  EXPECT_GT(e.rig.out.force_N.z(), 0.5);
}

TEST_P(SafetyExtremes, NanPositionsForFiveTicks) {
  Extreme e(GetParam());
  e.name = "NaN positions for 5 ticks";
  e.rig.blind = true;
  e.rig.run(5);
  e.rig.blind = false;
  e.rig.run(500);
}

TEST_P(SafetyExtremes, ObjectArrivesFast) {
  Extreme e(GetParam(), 5.0);
  e.name = "object arrives at 0.9 m/s";
  e.rig.wall_mm = -20.0;
  e.raiseWall(900.0, 33);
  e.rig.run(1000);
  EXPECT_GT(e.rig.max_force_N, 0.5);
}

TEST_P(SafetyExtremes, DisconnectAndDeviceLost) {
  Extreme e(GetParam());
  e.name = "disconnect, reconnect, device lost";
  e.rig.wall_present = e.rig.touchable = false;
  e.rig.run(300);
  EXPECT_EQ(e.rig.out.force_N, Vec3(Vec3::Zero()));
  e.rig.wall_present = e.rig.touchable = e.rig.epoch_jump = true;
  e.rig.run(500);
  e.rig.lost = true;
  e.rig.run(100);
  EXPECT_EQ(e.rig.out.force_N, Vec3(Vec3::Zero()));
  e.rig.lost = false;
  e.rig.chain.rearm();
  e.rig.run(500);
}

TEST_P(SafetyExtremes, GainsChangeUnderTheHand) {
  Extreme e(GetParam());
  e.name = "stiffness 0.1, 5, 0.5 in turn";
  const double own = e.rig.stiffness_N_mm;
  for (const double k : {0.1, 5.0, 0.5, own}) {
    e.rig.stiffness_N_mm = k;
    e.rig.step();
    e.rig.run(200);
  }
}

}  // namespace
}  // namespace hapticast::client
