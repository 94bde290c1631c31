// SPDX-License-Identifier: MIT
#include "client/device/falcon/kinematics.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>
#include <random>
#include <vector>

namespace hapticast::client {
namespace {

/// Poses all over the ball of 40 mm in which the device is used.
std::vector<Vec3> workspace_m(int count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> side(-0.040, 0.040);
  std::vector<Vec3> poses_m;
  while (poses_m.size() < static_cast<std::size_t>(count)) {
    const Vec3 offset_m(side(random), side(random), side(random));
    if (offset_m.norm() <= 0.040) poses_m.push_back(kFalconCentre_m + offset_m);
  }
  return poses_m;
}

TEST(FalconKinematics, DepthOverEqualCounts) {
  // Computed once by an independent program from the published lengths.
  const std::vector<std::pair<int, double>> depths_mm = {
      {0, 134.6}, {-1000, 89.6}, {-500, 110.8}, {500, 156.9}, {1000, 173.6}};
  for (const auto& [counts, depth_mm] : depths_mm) {
    const auto position_m =
        falconForward_m(falconAngles_rad({counts, counts, counts}), kFalconCentre_m);
    ASSERT_TRUE(position_m) << counts;
    EXPECT_NEAR(1e3 * position_m->z(), depth_mm, 0.06) << counts;
    EXPECT_NEAR(position_m->head<2>().norm(), 0.0, 1e-9) << counts;
  }
}

TEST(FalconKinematics, ForwardUndoesInverseAllOverTheWorkspace) {
  double worst_mm = 0.0;
  double least = 0.0;
  double most = 0.0;
  for (const Vec3& position_m : workspace_m(5000)) {
    const auto angles_rad = falconInverse_rad(position_m);
    ASSERT_TRUE(angles_rad) << position_m.transpose();
    const auto again_m = falconForward_m(*angles_rad, kFalconCentre_m);
    ASSERT_TRUE(again_m) << position_m.transpose();
    worst_mm = std::max(worst_mm, 1e3 * (*again_m - position_m).norm());
    const Vec3 counts = falconEncoders(*angles_rad);
    least = std::min(least, counts.minCoeff());
    most = std::max(most, counts.maxCoeff());
  }
  EXPECT_LT(worst_mm, 1e-6);
  EXPECT_GE(least, -1429.5);
  EXPECT_LE(most, 887.5);
  EXPECT_LT(least, -1300.0) << "the poses reach the borders";
  EXPECT_GT(most, 830.0);
}

TEST(FalconKinematics, TheJacobianIsTheDerivative) {
  constexpr double kStep_m = 1e-6;
  for (const Vec3& position_m : workspace_m(1000)) {
    const auto jacobian = falconJacobian_rad_m(position_m);
    ASSERT_TRUE(jacobian);
    Eigen::Matrix3d differences;
    for (int i = 0; i < 3; ++i) {
      const Vec3 step_m = kStep_m * Vec3::Unit(i);
      differences.col(i) =
          (*falconInverse_rad(position_m + step_m) - *falconInverse_rad(position_m - step_m)) /
          (2.0 * kStep_m);
    }
    EXPECT_LT((*jacobian - differences).norm(), 1e-6 * jacobian->norm()) << position_m.transpose();
  }
}

TEST(FalconKinematics, TorquesMoveAsMuchPowerAsTheForce) {
  double most_sideways = 0.0;
  double most = 0.0;
  for (const Vec3& position_m : workspace_m(1000)) {
    const Vec3 force_N(0.7, -1.3, 2.1);
    const Vec3 velocity_m_s(0.02, 0.05, -0.03);
    const Vec3 rates = *falconJacobian_rad_m(position_m) * velocity_m_s;
    const Vec3 torques = *falconTorques(position_m, force_N);
    EXPECT_NEAR(torques.dot(rates), force_N.dot(velocity_m_s), 1e-12);
    most_sideways =
        std::max(most_sideways, falconTorques(position_m, Vec3::UnitX())->cwiseAbs().maxCoeff());
    for (int i = 0; i < 3; ++i)
      most = std::max(most, falconTorques(position_m, Vec3::Unit(i))->cwiseAbs().maxCoeff());
  }
  EXPECT_GT(most_sideways, 0.053);
  EXPECT_LT(most, 0.085) << "N m for each newton";
  const Vec3 push = *falconTorques({0.0, 0.0, 0.110}, Vec3::UnitZ());
  EXPECT_NEAR(push.minCoeff(), 0.0242, 1e-4);
  EXPECT_NEAR(push.maxCoeff(), 0.0242, 1e-4);
}

TEST(FalconKinematics, RefusesAPlaceOutOfReach) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3& far_m : {Vec3(0.0, 0.0, 0.4), Vec3(0.3, 0.0, 0.1), Vec3(0.0, -1.0, 0.1),
                            Vec3(nan, 0.0, 0.1), Vec3(0.0, 0.0, nan)}) {
    EXPECT_FALSE(falconInverse_rad(far_m));
    EXPECT_FALSE(falconJacobian_rad_m(far_m));
    EXPECT_FALSE(falconTorques(far_m, Vec3::UnitX()));
  }
  EXPECT_FALSE(falconForward_m({3.0, -3.0, 3.0}, kFalconCentre_m));
  EXPECT_FALSE(falconForward_m({nan, 0.5, 0.5}, kFalconCentre_m));
}

TEST(FalconKinematics, MotorsThatSaturateKeepTheirDirection) {
  EXPECT_EQ(falconMotors({0.01, -0.02, 0.0}, 3500.0, 2000), (std::array{-35, 70, 0}));
  EXPECT_EQ(falconMotors({1.0, -2.0, 0.5}, 3500.0, 2000), (std::array{-1000, 2000, -500}));
  EXPECT_EQ(falconMotors({std::nan(""), 1.0, 1.0}, 3500.0, 2000), (std::array{0, 0, 0}));
}

}  // namespace
}  // namespace hapticast::client
