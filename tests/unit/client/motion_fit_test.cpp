// SPDX-License-Identifier: MIT
#include "client/device/motion_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "client/device/virtual/axis_plant.hpp"

namespace hapticast::client {
namespace {

struct FreeMotion {
  std::vector<double> force_N;
  std::vector<double> position_mm;
};

/// A free device that gets 0.3 N to and fro and to, 30, 60 and 30 ms.
FreeMotion pushFree(const PlantProfile& plant, double weight_N = 0.0) {
  AxisPlant axis(plant, Hand::none());
  axis.reset(0.0, 0.0);
  FreeMotion motion;
  for (int tick = 0; tick < 180; ++tick) {
    const double force_N = tick < 30 ? 0.3 : tick < 90 ? -0.3 : tick < 120 ? 0.3 : 0.0;
    motion.position_mm.push_back(std::round(1e3 * axis.position_m() / plant.count_mm) *
                                 plant.count_mm);
    motion.force_N.push_back(force_N);
    const int acting = tick - plant.delay_ticks;
    const double sent_N = acting < 0 ? 0.0 : motion.force_N[static_cast<std::size_t>(acting)];
    axis.advance(sent_N - weight_N, 0.0, 0.0);
  }
  return motion;
}

TEST(MotionFit, FindsMassAndDelayOfAFreeDevice) {
  std::mt19937 random(20261127);
  const auto draw = [&random](double from, double to) {
    return std::uniform_real_distribution(from, to)(random);
  };
  for (int i = 0; i < 300; ++i) {
    PlantProfile plant;
    plant.mass_kg = draw(0.03, 0.25);
    plant.delay_ticks = i % 6;
    plant.friction_N = draw(0.0, 0.08);
    plant.damping_Ns_m = draw(0.05, 0.5);
    plant.count_mm = draw(0.01, 0.06);
    const double weight_N = draw(-0.1, 0.1);
    const FreeMotion motion = pushFree(plant, weight_N);
    const MotionFit fit = fitMotion(motion.force_N, motion.position_mm);
    EXPECT_NEAR(fit.mass_kg, plant.mass_kg, 0.15 * plant.mass_kg)
        << i << ": friction " << plant.friction_N << ", weight " << weight_N;
    EXPECT_NEAR(fit.delay_ticks, plant.delay_ticks, 1) << i;
  }
}

TEST(MotionFit, AMotionAgainstTheForceHasNoMass) {
  PlantProfile plant;
  FreeMotion motion = pushFree(plant);
  for (double& each_mm : motion.position_mm) each_mm = -each_mm;
  EXPECT_LT(fitMotion(motion.force_N, motion.position_mm).mass_kg, 0.0);
}

TEST(MotionFit, AnAxisThatDoesNotMoveHasNoMass) {
  FreeMotion motion = pushFree({});
  std::fill(motion.position_mm.begin(), motion.position_mm.end(), 3.0);
  const MotionFit fit = fitMotion(motion.force_N, motion.position_mm);
  EXPECT_FALSE(fit.mass_kg > 0.0 && fit.mass_kg < 100.0);
}

}  // namespace
}  // namespace hapticast::client
