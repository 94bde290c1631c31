// SPDX-License-Identifier: MIT
// A device with an enabling button gives force only while it is held.
#include <gtest/gtest.h>

#include "tests/support/renderer_fixture.hpp"

namespace hapticast::client {
namespace {

RendererSettings withButton() {
  RendererSettings settings;
  settings.profile.enable_button = 2;
  return settings;
}
const HandScript kFollows{HandKind::kFollow, HandStiffness{}};

TEST(RendererEnable, NoForceBeforeTheButtonIsHeld) {
  RendererFixture stage(withButton(), &kFollows);
  stage.holds = false;
  (void)stage.run(3000);
  EXPECT_EQ(stage.max_force_N, 0.0);
  EXPECT_FALSE(stage.renderer->report().enabled);
}

TEST(RendererEnable, RendersWhileTheButtonIsHeldAndFadesAfterwards) {
  RendererFixture stage(withButton(), &kFollows);
  (void)stage.run(3000);
  EXPECT_TRUE(stage.renderer->report().enabled);
  EXPECT_GT(stage.renderer->report().force_N.norm(), 0.2);
  for (int again = 0; again < 5; ++again) {
    stage.holds = false;
    EXPECT_EQ(stage.run(150).force_N, Vec3(Vec3::Zero()));
    EXPECT_EQ(stage.run(500).force_N, Vec3(Vec3::Zero()));
    stage.holds = true;
    EXPECT_LT(stage.step().force_N.norm(), 0.01);  // faded in
    (void)stage.run(1000);
  }
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(RendererEnable, ATipThatSankInMeanwhileIsNotThrownOut) {
  RendererFixture stage(withButton(), nullptr);
  stage.device.setTarget(stage.renderer->report().mapping.toDevice({10.0, 5.0, 40.0}));
  (void)stage.run(2000);
  stage.holds = false;
  stage.device.setTarget(stage.renderer->report().mapping.toDevice({10.0, 5.0, 2.0}));
  (void)stage.run(2000);
  stage.max_force_N = 0.0;
  stage.holds = true;
  (void)stage.run(1000);
  EXPECT_EQ(stage.max_force_N, 0.0);
  EXPECT_TRUE((stage.renderer->report().safety_actions & bit(SafetyAction::kDisarmed)) != 0);
}

TEST(RendererEnable, ADeviceWithoutTheButtonNeedsNone) {
  RendererFixture stage({}, &kFollows);
  stage.holds = false;
  EXPECT_GT(stage.run(3000).force_N.norm(), 0.2);
}

TEST(RendererEnable, WithoutDataTheLastStateOfTheButtonHoldsForAMoment) {
  RendererFixture stage(withButton(), &kFollows);
  (void)stage.run(3000);
  stage.silent = true;
  stage.holds = false;
  EXPECT_GT(stage.run(5).force_N.norm(), 0.2);
  EXPECT_EQ(stage.run(200).force_N, Vec3(Vec3::Zero()));
}

TEST(RendererEnable, ADeviceWithoutAnAnswerIsNotHeld) {
  RendererFixture stage(withButton(), &kFollows);
  stage.silent = true;
  (void)stage.run(100);
  EXPECT_FALSE(stage.renderer->report().enabled);
  EXPECT_EQ(stage.max_force_N, 0.0);
}

TEST(RendererEnable, ATipThatSinksInWhileTheForceStillFadesIsNotThrownOut) {
  RendererFixture stage(withButton(), nullptr);
  stage.device.setTarget(stage.renderer->report().mapping.toDevice({10.0, 5.0, 40.0}));
  (void)stage.run(2000);
  stage.holds = false;
  (void)stage.step();
  stage.device.setTarget(stage.renderer->report().mapping.toDevice({10.0, 5.0, -20.0}));
  (void)stage.run(90);
  stage.max_force_N = 0.0;
  stage.holds = true;
  (void)stage.run(1000);
  EXPECT_EQ(stage.max_force_N, 0.0);
}

}  // namespace
}  // namespace hapticast::client
