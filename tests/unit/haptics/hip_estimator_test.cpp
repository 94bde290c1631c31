// SPDX-License-Identifier: MIT
// Noise and error of the acceleration from counts are measured by hapticast-evaluate accuracy.
#include "client/haptics/estimation/hip_estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hapticast::client {
namespace {

DeviceState stateAt(double t_s, double z_mm) {
  DeviceState state;
  state.time = LocalTime(Duration(std::llround(t_s * 1e9)));
  state.position_mm = {0.0, 0.0, z_mm};
  return state;
}

TEST(HipEstimator, SteadyGainsAreThePrototypes) {
  struct Row {
    double count_mm, k1, k2, k3;
  };
  for (const Row& row : {Row{0.055, 0.919, 1020, 5.66e5}, Row{0.038, 0.942, 1144, 6.95e5},
                         Row{0.020, 0.971, 1351, 9.40e5}, Row{0.010, 0.988, 1536, 1.19e6}}) {
    const KalmanGains gains = steadyGains(row.count_mm);
    EXPECT_NEAR(gains.position, row.k1, 0.001) << row.count_mm;
    EXPECT_NEAR(gains.velocity_per_s, row.k2, 0.005 * row.k2) << row.count_mm;
    EXPECT_NEAR(gains.acceleration_per_s2, row.k3, 0.005 * row.k3) << row.count_mm;
  }
}

TEST(HipEstimator, FollowsAConstantAccelerationExactly) {
  HipEstimator motion(DeviceProfile{});
  HipEstimate estimate;
  for (int i = 0; i <= 400; ++i) {
    const double t = i * 1e-3;
    estimate = motion.update(stateAt(t, 0.5 * 2000.0 * t * t));
  }
  EXPECT_NEAR(estimate.velocity_mm_s.z(), 800.0, 1e-6);
  EXPECT_NEAR(estimate.acceleration_m_s2.z(), 2.0, 1e-6);
  EXPECT_DOUBLE_EQ(estimate.velocity_mm_s.x(), 0.0);
}

TEST(HipEstimator, LateTickTakesTheMeanVelocityOfTheGap) {
  HipEstimator motion(DeviceProfile{});
  for (int i = 0; i < 50; ++i) (void)motion.update(stateAt(i * 1e-3, 0.0));
  const HipEstimate& late = motion.update(stateAt(49e-3 + 10e-3, 1.0));
  EXPECT_FALSE(late.restarted);
  EXPECT_NEAR(late.velocity_mm_s.z(), 100.0, 1e-9);
  const HipEstimate& next = motion.update(stateAt(60e-3, 1.1));
  EXPECT_NEAR(next.velocity_mm_s.z(), 100.0,
              1e-6);  // goes on straight: nothing was predicted through the gap
}

TEST(HipEstimator, StartsOverWhenTimeJumps) {
  for (const double t : {0.0, 0.1, -5.0}) {  // standing, too late, backwards
    HipEstimator motion(DeviceProfile{});
    (void)motion.update(stateAt(-1e-3, -1.0));
    (void)motion.update(stateAt(0.0, 0.0));
    const HipEstimate& estimate = motion.update(stateAt(t, 5.0));
    EXPECT_TRUE(estimate.restarted) << t;
    EXPECT_EQ(estimate.velocity_mm_s, Vec3(Vec3::Zero())) << t;
    EXPECT_EQ(estimate.position_mm.z(), 5.0) << t;
  }
}

TEST(HipEstimator, ALeapIsNotAMovement) {
  HipEstimator motion(DeviceProfile{});
  (void)motion.update(stateAt(0.0, 0.0));
  EXPECT_FALSE(motion.update(stateAt(1e-3, 2.0)).restarted);  // 2 m/s: a hand
  EXPECT_TRUE(motion.update(stateAt(2e-3, 60.0)).restarted);  // 58 m/s: the device was re-homed
}

TEST(HipEstimator, KeepsTheLastWhenTheDeviceReportsNothingOrNonsense) {
  HipEstimator motion(DeviceProfile{});
  for (int i = 0; i < 20; ++i) (void)motion.update(stateAt(i * 1e-3, 0.1 * i));
  const double before_mm_s = motion.update(stateAt(20e-3, 2.0)).velocity_mm_s.z();
  const HipEstimate nan = motion.update(stateAt(21e-3, std::nan("")));
  EXPECT_FALSE(nan.finite);
  EXPECT_EQ(nan.position_mm.z(), 2.0);
  EXPECT_EQ(nan.velocity_mm_s.z(), before_mm_s);
  const HipEstimate infinite =
      motion.update(stateAt(22e-3, std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(infinite.finite);
  DeviceState silent = stateAt(23e-3, 99.0);
  silent.status = DeviceStatus::kNoData;
  const HipEstimate none = motion.update(silent);
  EXPECT_TRUE(none.finite);
  EXPECT_EQ(none.ticks_without_data, 3);
  EXPECT_EQ(none.position_mm.z(), 2.0);
  const HipEstimate& again = motion.update(stateAt(24e-3, 2.4));
  EXPECT_EQ(again.ticks_without_data, 0);
  EXPECT_NEAR(again.velocity_mm_s.z(), 100.0, 1e-9);
}

}  // namespace
}  // namespace hapticast::client
