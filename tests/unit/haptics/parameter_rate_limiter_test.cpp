// SPDX-License-Identifier: MIT
// A material changes under the hand within 0.3 s, out of contact at once; an author's stiffness has
// a limit that is the user's.
#include "client/haptics/parameter_rate_limiter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/support/renderer_fixture.hpp"
#include "tests/unit/haptics/proxy_bench.hpp"

namespace hapticast::client {
namespace {

TEST(ParameterRateLimiter, TakesThreeTenthsOfASecondInContactAndNoTimeElsewhere) {
  ParameterRateLimiter ramp;
  EXPECT_EQ(ramp.step(2.0, false), 2.0);
  EXPECT_EQ(ramp.step(0.5, false), 0.5);
  for (int i = 1; i <= 300; ++i) EXPECT_NEAR(ramp.step(3.5, true), 0.5 + 0.01 * i, 1e-9);
  EXPECT_EQ(ramp.step(3.5, true), 3.5);
  EXPECT_NEAR(ramp.step(0.5, true), 3.49, 1e-9);
}

TEST(ParameterRateLimiter, AStreamThatFlipsMovesItByAShareOnly) {
  ParameterRateLimiter ramp;
  (void)ramp.step(0.0, false);
  double low = 1.0;
  double high = 0.0;
  for (int i = 0; i < 3000; ++i) {  // 7 Hz between 0 and 1
    const double value = ramp.step(i / 71 % 2 == 0 ? 1.0 : 0.0, true);
    if (i < 1500) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  EXPECT_LT(high - low, 0.2);
}

TEST(ParameterRateLimiter, ANumberThatIsNoneLeavesNoTrace) {
  ParameterRateLimiter ramp;
  (void)ramp.step(1.0, false);
  EXPECT_TRUE(std::isnan(ramp.step(std::numeric_limits<double>::quiet_NaN(), true)));
  EXPECT_EQ(ramp.step(1.0, true), 1.0);
}

/// Rendered stiffness at a hand that is pressed 2 mm into a dome, over `ticks`.
double settleStiffness_N_mm(RendererFixture& stage, int ticks) {
  double force_N = 0.0;
  double device_mm = 0.0;
  for (int i = 0; i < ticks; ++i) {
    const TickReport& report = stage.step();
    force_N += report.static_force_N.norm();
    device_mm += report.penetration_mm * report.mapping.scale;
  }
  return force_N / device_mm;
}

void press(RendererFixture& stage) {
  const Vec3 top = DeviceMapping::fit(Workspace{}, {160, 120, 70}).toDevice({10.0, 5.0, 17.0});
  stage.device.reset(top + Vec3(0, 0, 2.0), Vec3::Zero());
  (void)stage.run(500);
  stage.device.setTarget(top - Vec3(0, 0, 2.0));
  (void)stage.run(2000);
}

TEST(ParameterRateLimiterUse, StiffnessChangesSlowlyUnderTheHand) {
  RendererFixture stage({}, nullptr);
  stage.material.stiffness_N_mm = 0.3;
  press(stage);
  EXPECT_NEAR(settleStiffness_N_mm(stage, 200), 0.3, 0.01);
  stage.material.stiffness_N_mm = 1.5;
  while (settleStiffness_N_mm(stage, 1) < 0.32) {  // until the frame is played
  }
  (void)stage.run(75);
  EXPECT_NEAR(settleStiffness_N_mm(stage, 150), 0.9, 0.1);  // the mean of the ramp's middle
  (void)stage.run(300);
  EXPECT_NEAR(settleStiffness_N_mm(stage, 500), 1.5, 0.03);
}

TEST(ParameterRateLimiterUse, AnAuthorsStiffnessHasALimit) {
  struct Case {
    double limit, asked, settled;
  };
  for (const Case& c : {Case{0.0, 3.0, 1.5}, Case{2.5, 3.0, 2.5}, Case{3.0, 2.0, 2.0}}) {
    RendererSettings settings;
    settings.stiffness_limit_N_mm = c.limit;
    RendererFixture stage(settings, nullptr);
    stage.material.stiffness_N_mm = c.asked;
    press(stage);
    EXPECT_NEAR(settleStiffness_N_mm(stage, 500), c.settled, 0.02 * c.settled);
    const bool logged =
        (stage.renderer->report().safety_actions & bit(SafetyAction::kStiffness)) != 0U;
    EXPECT_EQ(logged, c.settled < c.asked);
  }
}

TEST(ParameterRateLimiterUse, FrictionChangesSlowlyUnderTheHandAndHasALimit) {
  Table table;
  table.put(1, relief(20.0, level(10.0), slantedBox()));
  Material& material = table.object(0).material;
  material.static_friction = material.dynamic_friction = 0.0;
  (void)table.move({0.0, 0.0, 11.0}, {0.0, 0.0, 9.0});
  material.static_friction = material.dynamic_friction = 1e30;
  double x_mm = 0.0;
  const auto slope = [&](int ticks) {
    double most = 0.0;
    for (int i = 0; i < ticks; ++i, x_mm += 0.01) {
      const Vec3 way = table.touch({x_mm, 0.0, 9.0}).displacement_mm;
      most = std::max(most, -way.x() / way.z());
    }
    return most;
  };
  EXPECT_LT(slope(30), 0.16);
  EXPECT_NEAR(slope(500), 1.5, 0.02);
}

}  // namespace
}  // namespace hapticast::client
