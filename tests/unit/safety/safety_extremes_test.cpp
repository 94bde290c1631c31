// SPDX-License-Identifier: MIT
// Extreme cases that end and begin again: no step of the force that the hand does not explain. The
// claims of hapticast-evaluate stability --only cases have all cases of one event.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {
namespace {

/// A light hand that wants to be at `target_mm` beside a wall of K N/mm, friction 0.05 N.
class SafetyExtremes : public ::testing::TestWithParam<double> {
 protected:
  void reach(double target_mm) {
    rig.device.reset({0.0, 0.0, 10.0}, Vec3::Zero());
    rig.run(300);
    for (int i = 0; i < 600; ++i) {
      rig.device.setTarget({0.0, 0.0, 10.0 + (target_mm - 10.0) * std::min(1.0, i / 300.0)});
      rig.step();
    }
    rig.run(1000);
    rig.clear();
  }
  void TearDown() override {
    EXPECT_TRUE(rig.finite);
    EXPECT_EQ(rig.max_excess_N, 0.0);
    EXPECT_LE(rig.max_force_N, 3.3 + 1e-9);
  }
  ChainFixture rig{omni(GetParam(), 1, 0.05), omni(GetParam(), 1, 0.05), Hand::light()};
};
INSTANTIATE_TEST_SUITE_P(Stiffness, SafetyExtremes, ::testing::Values(0.5, 1.0, 5.0));

TEST_P(SafetyExtremes, ASurfaceFarAboveTheTipAppearsAndLeaves) {
  reach(5.0);
  rig.wall_mm = 35.0;
  rig.run(1000);
  EXPECT_EQ(rig.max_force_N, 0.0);
  rig.wall_mm = 0.0;  // the hand is out: the force may return
  rig.run(300);
  rig.device.setTarget({0.0, 0.0, -5.0});
  rig.run(1000);
  EXPECT_GT(rig.out.force_N.z(), 0.5);
}

TEST_P(SafetyExtremes, DisconnectAndDeviceLost) {
  reach(-5.0);
  rig.wall_present = rig.touchable = false;
  rig.run(300);
  EXPECT_EQ(rig.out.force_N, Vec3(Vec3::Zero()));
  rig.wall_present = rig.touchable = rig.epoch_jump = true;
  rig.run(500);
  rig.lost = true;
  rig.run(100);
  EXPECT_EQ(rig.out.force_N, Vec3(Vec3::Zero()));
  rig.lost = false;
  rig.chain.rearm();
  rig.run(500);
}

}  // namespace
}  // namespace hapticast::client
