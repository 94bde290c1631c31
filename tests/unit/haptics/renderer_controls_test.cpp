// SPDX-License-Identifier: MIT
// The user's controls during contact: they take effect without a step.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/renderer_fixture.hpp"

namespace hapticast::client {
namespace {

/// A hand that lies on the dome and follows it.
class RendererControls : public ::testing::Test {
 protected:
  RendererControls() { (void)stage.run(3000); }
  const TickReport& after(int ticks) {
    stage.user.store(stage.wishes);
    return stage.run(ticks);
  }
  /// The mean of the force over a while, in which the scene does the same.
  double force_N() {
    stage.user.store(stage.wishes);
    double sum_N = 0.0;
    constexpr int kTicks = 2000;
    for (int i = 0; i < kTicks; ++i) sum_N += stage.step().force_N.norm() / kTicks;
    return sum_N;
  }
  HandScript hand{HandKind::kSlide, HandStiffness{}};
  RendererFixture stage{{}, &hand, 3.0};
};

TEST_F(RendererControls, StaticAndDynamicForceGoOffAndOnWithoutAStep) {
  ASSERT_GT(force_N(), 0.2);
  stage.wishes.static_on = false;
  EXPECT_EQ(after(1000).static_force_N, Vec3(Vec3::Zero()));
  stage.wishes.dynamic_on = false;
  EXPECT_EQ(after(1000).dynamic_force_N, Vec3(Vec3::Zero()));
  EXPECT_EQ(stage.run(1).force_N, Vec3(Vec3::Zero()));
  stage.wishes.static_on = stage.wishes.dynamic_on = true;
  (void)after(3000);
  EXPECT_GT(force_N(), 0.2);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST_F(RendererControls, ALowerForceAndASofterWallTakeEffect) {
  const double all_N = force_N();
  stage.wishes.force_factor = 0.0;
  (void)after(1000);
  EXPECT_EQ(force_N(), 0.0);
  stage.wishes.force_factor = 1.0;
  (void)after(3000);
  stage.wishes.stiffness_factor = 0.2;
  (void)after(1000);
  const double soft_N = force_N();
  EXPECT_GT(soft_N, 0.02);
  EXPECT_LT(soft_N, 0.6 * all_N);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST_F(RendererControls, MethodAndSurfaceAreSwitchedUnderTheHand) {
  for (int i = 0; i < 4; ++i) {
    stage.wishes.method = i % 2 == 0 ? Method::kThesis : Method::kHapticast;
    EXPECT_EQ(after(10).force_N.norm() > 3.3, false);
    (void)after(1500);
    stage.wishes.surface = i % 2 == 0 ? SurfaceKind::kNormal : SurfaceKind::kPerturbed;
    (void)after(1500);
  }
  EXPECT_GT(stage.max_force_N, 0.2);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(RendererControlsPaused, TheThesissMethodLetsTheHandLeaveAFrameThatStands) {
  RendererSettings settings;
  settings.method = Method::kThesis;
  settings.surface = SurfaceKind::kPerturbed;
  RendererFixture stage(settings, nullptr);
  (void)stage.run(100);
  const auto lead = [&](double z_mm) -> const TickReport& {
    stage.device.setTarget(stage.renderer->report().mapping.toDevice({10.0, 5.0, z_mm}));
    return stage.run(1500);
  };
  EXPECT_FALSE(lead(25.0).contact);
  EXPECT_TRUE(lead(14.0).contact);
  stage.pause(true);
  EXPECT_GT(stage.run(1000).force_N.z(), 0.1);
  EXPECT_FALSE(lead(25.0).contact);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST_F(RendererControls, NothingThatIsSetLeavesTheLimits) {
  const double nan = std::nan("");
  for (const double value : {1e9, -5.0, double{INFINITY}, nan, 3.0}) {
    stage.wishes.stiffness_factor = value;
    stage.wishes.force_factor = value;
    stage.wishes.friction = value;
    const TickReport& report = after(1500);
    ASSERT_TRUE(report.force_N.allFinite());
  }
  EXPECT_LE(stage.max_force_N, stage.settings.profile.peak_N + 1e-9);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

}  // namespace
}  // namespace hapticast::client
