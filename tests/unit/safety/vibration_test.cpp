// SPDX-License-Identifier: MIT
// Pressing steadily, nothing vibrates.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "tests/support/vibration.hpp"

namespace hapticast::client {
namespace {

struct Worst {
  double rubbed_N = 0.0;  ///< above 50 Hz, with friction
  double smooth_N = 0.0;  ///< ... and without
  double counts = 0.0;
};

/// Every K up to K_max, every delay; `later`: ticks the device takes longer than assumed.
Worst worstOf(const std::vector<NamedHand>& hands, int later, double real_kg,
              const std::vector<double>& frictions_N) {
  Worst worst;
  for (const int d : {0, 1, 2, 3, 5}) {
    const double most_N_mm = stiffnessLimit_N_mm(omni(1.0, d));
    for (const double k : {0.5, 1.0, 2.0, 5.0, most_N_mm}) {
      if (k > most_N_mm) continue;
      for (const auto& [name, hand] : hands) {
        for (const double friction_N : frictions_N) {
          const PlantProfile assumed = sweepProfile(k, d, friction_N);
          PlantProfile real = assumed;
          real.delay_ticks += later;
          real.mass_kg = real_kg;
          const Silence got = pressSteadily(assumed, real, hand, {.wall_mm = 0.02});
          EXPECT_LE(got.excess_N, 1e-9) << name << " K " << k << " d " << d;
          double& most_N = friction_N > 0.0 ? worst.rubbed_N : worst.smooth_N;
          most_N = std::max(most_N, got.above_50Hz_N);
          worst.counts = std::max(worst.counts, got.residual_mm / assumed.count_mm);
        }
      }
    }
  }
  std::printf("later %d, %.0f g: %.3f N with friction, %.3f N without, %.2f counts\n", later,
              real_kg * 1e3, worst.rubbed_N, worst.smooth_N, worst.counts);
  return worst;
}

TEST(SafetySilence, SevenHandsOnEveryWall) {
  for (const int later : {0, 1}) {
    const Worst worst = worstOf(quietHands(), later, 0.045, {0.0, 0.05});
    EXPECT_LE(worst.rubbed_N, 0.03);
    EXPECT_LE(worst.smooth_N, 0.05);
    EXPECT_LE(worst.counts, 2.0);
  }
}

TEST(SafetySilence, ADeviceLighterOrHeavierThanItsProfile) {
  for (const double real_kg : {0.035, 0.07}) {
    const Worst worst = worstOf(quietHands(), 0, real_kg, {0.0, 0.05});
    EXPECT_LE(worst.rubbed_N, 0.03);
    EXPECT_LE(worst.smooth_N, 0.05);
    EXPECT_LE(worst.counts, 2.0);
  }
}

TEST(SafetySilence, HeavyRigidArms) {
  for (const int later : {0, 1}) {
    for (const double real_kg : {0.035, 0.045, 0.07}) {
      const Worst worst = worstOf(heavyArms(), later, real_kg, {0.0});
      EXPECT_LE(worst.smooth_N, 0.05);
      EXPECT_LE(worst.counts, 2.0);
    }
  }
}

}  // namespace
}  // namespace hapticast::client
