// SPDX-License-Identifier: MIT
// Stability: the residual motion at rest after an impact, with and without a hand.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/plant_sweep.hpp"

namespace hapticast::client {
namespace {

/// Worst residual of the two holds in counts.
double residual(double stiffness_N_mm, int delay_ticks, const Hand& hand, double friction_N) {
  const PlantProfile profile = sweepProfile(stiffness_N_mm, delay_ticks, friction_N);
  ChainFixture rig(profile, profile, hand);
  const SweepResult result = sweepPlant(rig, hand);
  EXPECT_EQ(rig.max_excess_N, 0.0);
  EXPECT_TRUE(result.released);
  return result.counts(profile.count_mm);
}

TEST(PlantSweep, IsQuietUpToTheStiffestWall) {
  for (int d = 0; d <= 2; ++d) {
    for (const double k : {0.5, 1.0, 2.0, 5.0, 10.0}) {
      if (k > 1.01 * stiffnessLimit_N_mm(omni(k, d)) && k > 2.0) continue;
      for (const auto& [name, hand] : kHands) {
        const double rough = residual(k, d, hand, 0.0);
        const double rubbed = residual(k, d, hand, 0.05);
        std::printf("battery d %d K %4.1f %-10s residual %.2f counts, with friction %.2f\n", d, k,
                    name, rough, rubbed);
        EXPECT_LE(rough, 2.0) << name << " K " << k << " d " << d;
        EXPECT_LE(rubbed, 2.0) << name << " K " << k << " d " << d;
      }
    }
  }
}

TEST(PlantSweep, DetectsAWallThatIsTooStiffForItsDelay) {
  // The test above can fail: without an assumed delay, with two ticks of it, a free device runs
  // away at 5 N/mm.
  ChainFixture rig(sweepProfile(5.0, 0), sweepProfile(5.0, 2), Hand::none(),
                   {.oscillation_detector = false});
  EXPECT_GT(sweepPlant(rig, Hand::none()).counts(0.055), 10.0);
}

}  // namespace
}  // namespace hapticast::client
