// SPDX-License-Identifier: MIT
// A short case each of what hapticast-evaluate stability proves with figures: the sweep (chain),
// random life (life), a silent press (silence).
#include <gtest/gtest.h>

#include "client/device/profile/device_profile.hpp"
#include "tests/support/soak.hpp"
#include "tests/support/vibration.hpp"

namespace hapticast::client {
namespace {

TEST(PlantSweep, IsQuietOnAWallOfOneNewtonPerMillimetre) {
  const PlantProfile profile = sweepProfile(1.0, 1, 0.05);
  ChainFixture rig(profile, profile, Hand::light());
  const SweepResult result = sweepPlant(rig, Hand::light(), true);
  EXPECT_LE(result.counts(profile.count_mm), 2.0);
  EXPECT_EQ(rig.max_excess_N, 0.0);
  EXPECT_TRUE(result.released);
}

/// Everything at once; returns where it ends, so that two lives can be compared.
Vec3 live(int seconds) {
  const PlantProfile profile = loadDeviceProfile("omni");
  ChainFixture rig(profile, profile, Hand::lightGrip());
  const LifeResult result = Life(rig, 7).live(seconds);
  EXPECT_TRUE(rig.finite);
  EXPECT_LE(rig.max_force_N, profile.peak_N + 1e-9);
  EXPECT_EQ(rig.max_excess_N, 0.0);
  EXPECT_EQ(result.alarms, 0);
  EXPECT_GT(rig.max_force_N, 1.0);
  const PortWork& work = rig.chain.work();
  EXPECT_LE(work.relative_mJ, 0.0);
  EXPECT_GT(work.surface_mJ, 0.0);
  return result.end;
}

TEST(SafetyRunsLife, LivesTheSameLifeTwice) { EXPECT_EQ(live(20), live(20)); }

TEST(SafetyRunsSilence, ALightHandOnTheStiffestWall) {
  const PlantProfile profile = sweepProfile(stiffnessLimit_N_mm(omni(1.0, 1)), 1);
  const Silence got = pressSteadily(profile, profile, Hand::light(), {.wall_mm = 0.02});
  EXPECT_LE(got.above_50Hz_N, 0.05);
  EXPECT_LE(got.residual_mm / profile.count_mm, 2.0);
  EXPECT_LE(got.excess_N, 1e-9);
}

}  // namespace
}  // namespace hapticast::client
