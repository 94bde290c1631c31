// SPDX-License-Identifier: MIT
// The motors' heat: the sequence of a long press, and what rest gives back.
#include "client/haptics/safety/thermal_budget.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hapticast::client {
namespace {

/// The limit after `seconds` of pressing as hard as it allows.
double limitAfter_N(ThermalBudget& budget, double seconds) {
  for (int i = 0; i < static_cast<int>(seconds * 1e3); ++i) {
    budget.add(budget.limit_N() * budget.limit_N());
  }
  return budget.limit_N();
}

TEST(ThermalBudget, AllowsThePeakForAWhileAndTheContinuousForceForGood) {
  ThermalBudget budget{DeviceProfile{}};
  EXPECT_EQ(limitAfter_N(budget, 0.8), 3.3);
  EXPECT_NEAR(limitAfter_N(budget, 0.2), 2.9, 0.1);
  EXPECT_NEAR(limitAfter_N(budget, 0.5), 1.9, 0.1);
  EXPECT_NEAR(limitAfter_N(budget, 1.5), 1.1, 0.1);
  EXPECT_NEAR(limitAfter_N(budget, 2.0), 0.93, 0.03);
  EXPECT_NEAR(limitAfter_N(budget, 60.0), 0.88, 0.02);
}

TEST(ThermalBudget, NeverStepsAndKeepsTheMeanSquare) {
  ThermalBudget budget{DeviceProfile{}};
  double before_N = budget.limit_N();
  double square = 0.0;
  for (int i = 0; i < 60'000; ++i) {
    const double limit_N = budget.limit_N();
    EXPECT_LE(std::abs(limit_N - before_N), 0.01);
    before_N = limit_N;
    square += limit_N * limit_N / 60'000;
    budget.add(limit_N * limit_N);
  }
  EXPECT_NEAR(std::sqrt(square), 1.01, 0.02);
}

TEST(ThermalBudget, LeavesTheContinuousForceAlone) {
  const DeviceProfile profile;
  ThermalBudget budget(profile);
  for (int i = 0; i < 200'000; ++i) {
    budget.add(std::pow(0.97 * profile.continuous_N, 2));
    ASSERT_GE(budget.limit_N(), 0.97 * profile.continuous_N);
  }
  (void)limitAfter_N(budget, 20.0);
  for (int i = 0; i < 20'000; ++i) budget.add(0.0);  // rest
  EXPECT_EQ(budget.limit_N(), profile.peak_N);
}

TEST(ThermalBudget, ADeviceThatHoldsItsPeakForGoodIsHardlyLimited) {
  DeviceProfile profile;
  profile.continuous_N = profile.peak_N;
  ThermalBudget budget(profile);
  EXPECT_GE(limitAfter_N(budget, 100.0), 0.98 * profile.peak_N);
}

}  // namespace
}  // namespace hapticast::client
