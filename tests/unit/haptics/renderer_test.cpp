// SPDX-License-Identifier: MIT
#include "client/haptics/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "tests/support/renderer_fixture.hpp"

namespace hapticast::client {
namespace {

HandScript presser() { return {HandKind::kPress, HandStiffness{}}; }

TEST(HapticRenderer, APressedDomePushesBackWithOneNewton) {
  HandScript hand = presser();
  RendererFixture stage({}, &hand);
  int contact = 0;
  int interpolated = 0;
  std::vector<double> forces_N;
  for (int i = 0; i < 8000; ++i) {
    const TickReport& report = stage.step();
    contact += report.contact;
    interpolated += report.contact && report.lookup == Lookup::kInterpolated;
    if (report.contact) forces_N.push_back(report.force_N.z());
    EXPECT_EQ(report.penetration_mm > 0.0, report.contact);
  }
  EXPECT_GT(contact, 2000);
  EXPECT_GE(interpolated, 0.95 * contact);
  const auto middle = forces_N.begin() + contact / 2;  // mostly it holds
  std::nth_element(forces_N.begin(), middle, forces_N.end());
  EXPECT_NEAR(*middle, 1.0, 0.05);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, PressPushesOneNewtonWithoutMuchOvershoot) {
  HandScript hand = presser();
  RendererFixture stage({}, &hand);
  (void)stage.run(8000);
  EXPECT_GT(stage.max_force_N, 0.95);
  EXPECT_LT(stage.max_force_N, 1.3);
}

TEST(HapticRenderer, SlideStaysOneMillimetreDeepAtTwoCentimetresPerSecond) {
  HandScript hand{HandKind::kSlide, HandStiffness{}};
  RendererFixture stage({}, &hand);
  Vec3 last_mm = stage.run(2500).hip_mm;
  double depth_mm = 0.0;
  double deepest_mm = 0.0;
  double way_mm = 0.0;
  int contact = 0;
  for (int i = 1; i <= 8000; ++i) {
    const TickReport& report = stage.step();
    contact += report.contact;
    depth_mm += report.penetration_mm / 8000.0;
    deepest_mm = std::max(deepest_mm, report.penetration_mm);
    if (i % 50 != 0) continue;
    way_mm += (report.hip_mm - last_mm).head<2>().norm();
    last_mm = report.hip_mm;
  }
  EXPECT_EQ(contact, 8000);
  EXPECT_NEAR(depth_mm, 1.0, 0.15);
  EXPECT_LT(deepest_mm, 1.6);
  EXPECT_NEAR(way_mm / 8.0, 15.0, 5.0);  // 20 at most; slower where the figure turns
}

TEST(HapticRenderer, ReportsTheSurfaceBelowTheTip) {
  RendererFixture stage({}, nullptr);
  stage.device.reset(DeviceMapping::fit(Workspace{}, {160, 120, 70}).toDevice({12.0, 5.0, 40.0}),
                     Vec3::Zero());
  TickReport report = stage.run(500);
  EXPECT_TRUE(report.object_present);
  EXPECT_EQ(report.object_id, 7u);
  EXPECT_NEAR((report.object_centre_mm - Vec2(10.0, 5.0)).norm(), 0.0, 0.6);
  EXPECT_NEAR(report.object_centre_height_mm, 17.0, 0.05);
  EXPECT_TRUE(report.over_object);
  EXPECT_NEAR(report.height_at_hip_mm, 17.0 - 5.0 * 4.0 / 225.0, 0.05);
  EXPECT_NEAR((report.hip_mm - Vec3(12.0, 5.0, 40.0)).norm(), 0.0, 0.06);
  stage.device.reset({-60.0, 0.0, 10.0}, Vec3::Zero());
  report = stage.run(5);
  EXPECT_TRUE(report.object_present);
  EXPECT_FALSE(report.over_object);
  EXPECT_EQ(report.height_at_hip_mm, 0.0);
}

TEST(HapticRenderer, StiffnessIsTheSettingsElseTheMaterialsElseTheProfiles) {
  struct Case {
    double setting;
    std::optional<double> material;
    double expected;
  };
  for (const Case& c : {Case{0.0, {}, 0.5}, Case{0.0, 0.3, 0.3}, Case{0.8, 0.3, 0.8}}) {
    RendererSettings settings;
    settings.stiffness_N_mm = c.setting;
    RendererFixture stage(settings, nullptr);
    stage.material.stiffness_N_mm = c.material;
    const Vec3 top = DeviceMapping::fit(Workspace{}, {160, 120, 70}).toDevice({10.0, 5.0, 17.0});
    stage.device.reset(top + Vec3(0, 0, 2.0), Vec3::Zero());
    (void)stage.run(500);
    stage.device.setTarget(top - Vec3(0, 0, 2.0));
    (void)stage.run(2000);
    double force_N = 0.0;  // the mean: one count of chatter is a tenth of a Newton of damping
    double device_mm = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const TickReport& report = stage.step();
      force_N += report.static_force_N.norm();
      device_mm += report.penetration_mm * report.mapping.scale;
    }
    EXPECT_NEAR(force_N / device_mm, c.expected, 0.02 * c.expected);
  }
}

TEST(HapticRenderer, AStreamThatEndsFadesAndComesBackFromZero) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  RendererFixture stage({}, &hand, 3.0);
  EXPECT_GT(stage.run(3000).force_N.norm(), 0.2);
  stage.streaming = false;  // the server is killed
  bool seen[kLookupKinds] = {};
  for (int i = 0; i < 1000; ++i) seen[static_cast<int>(stage.step().lookup)] = true;
  EXPECT_TRUE(seen[static_cast<int>(Lookup::kExtrapolated)]);
  EXPECT_TRUE(seen[static_cast<int>(Lookup::kHeld)]);
  EXPECT_TRUE(seen[static_cast<int>(Lookup::kStale)]);
  EXPECT_EQ(stage.renderer->report().force_N, Vec3(Vec3::Zero()));
  stage.state.connected = false;
  stage.stream.store(stage.state);
  (void)stage.run(500);
  EXPECT_FALSE(stage.renderer->report().object_present);
  stage.state.connected = stage.streaming = true;  // and is back
  stage.newEpoch();
  EXPECT_GT(stage.run(3000).force_N.norm(), 0.2);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, EpochsPausesAndAnotherWorkspaceDoNotStep) {
  HandScript hand{HandKind::kSlide, HandStiffness{}};
  RendererFixture stage({}, &hand, 3.0);
  (void)stage.run(2500);
  for (int i = 0; i < 6; ++i) {
    stage.newEpoch();
    (void)stage.run(300);
    stage.pause(!stage.wishes.paused);
    (void)stage.run(300);
    stage.state.workspace.width_mm = i % 2 == 0 ? 200.0 : 160.0;
    stage.stream.store(stage.state);
    (void)stage.run(300);
  }
  EXPECT_GT(stage.max_force_N, 0.3);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, PausedTheFrameStandsStillWithoutDynamicForce) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  RendererFixture stage({}, &hand, 3.0);
  double most_dynamic_N = 0.0;
  for (int i = 0; i < 3000; ++i) {
    most_dynamic_N = std::max(most_dynamic_N, stage.step().dynamic_force_N.norm());
  }
  EXPECT_GT(most_dynamic_N, 0.02);
  stage.pause(true);
  const MediaTime stood = stage.run(200).play_time;
  for (int i = 0; i < 2000; ++i) {
    const TickReport& report = stage.step();
    ASSERT_EQ(report.play_time, stood);
    ASSERT_EQ(report.dynamic_force_N, Vec3(Vec3::Zero()));
    ASSERT_EQ(report.object_velocity_mm_s, Vec3(Vec3::Zero()));
  }
  EXPECT_GT(stage.renderer->report().force_N.norm(), 0.2) << "it stays to be explored";
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, AResumeRejoinsTheStreamLikeANewEpoch) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  RendererFixture stage({}, &hand, 3.0);
  const TickReport& report = stage.run(3000);
  const Duration behind = report.time.time_since_epoch() - report.play_time.time_since_epoch();
  stage.pause(true);
  (void)stage.run(2000);
  stage.pause(false);
  (void)stage.step();
  EXPECT_EQ(report.time.time_since_epoch() - report.play_time.time_since_epoch(), behind);
  EXPECT_EQ(report.lookup, Lookup::kEmpty) << "frames from before are void";
  EXPECT_FALSE(report.contact);
  EXPECT_EQ(stage.run(35).force_N, Vec3(Vec3::Zero())) << "what acted has ramped down";
  (void)stage.run(2000);
  EXPECT_GT(report.force_N.norm(), 0.2);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, ALostDeviceIsAFaultAndWaitsForRearm) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  RendererFixture stage({}, &hand);
  (void)stage.run(3000);
  stage.lost = true;
  EXPECT_EQ(stage.step().fault, Fault::kDeviceLost);
  EXPECT_EQ(stage.step().fault, Fault::kNone);  // once
  EXPECT_TRUE(stage.renderer->recorder().frozen());
  EXPECT_EQ(stage.renderer->report().device, DeviceStatus::kLost);
  stage.lost = false;
  EXPECT_EQ(stage.run(2000).force_N, Vec3(Vec3::Zero()));
  EXPECT_EQ(stage.renderer->report().device, DeviceStatus::kOk);
  EXPECT_EQ(stage.renderer->report().halt, Halt::kDeviceLost);
  stage.rearm();
  EXPECT_EQ(stage.step().halt, Halt::kNone);
  EXPECT_GT(stage.run(2000).force_N.norm(), 0.2);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, BlindTicksAreAFaultButLeaveTheForceSmooth) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  RendererFixture stage({}, &hand);
  (void)stage.run(3000);
  stage.blind = true;
  EXPECT_EQ(stage.step().fault, Fault::kNotFinite);
  EXPECT_TRUE(stage.run(4).force_N.allFinite());
  stage.blind = false;
  EXPECT_GT(stage.run(1000).force_N.norm(), 0.2);
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, AFullLogIsCountedNotWaitedFor) {
  auto log = std::make_unique<HapticRenderer::Log>();
  RendererFixture stage({}, nullptr, 0.0, log.get());
  (void)stage.run(5000);
  EXPECT_EQ(stage.renderer->droppedReports(), 5000u - 4096u);
  TickReport first;
  ASSERT_TRUE(log->tryPop(first));
  EXPECT_EQ(first.tick, 1u);
}

TEST(HapticRenderer, EvaluatesTheSceneWhereItPredictsTheHip) {
  for (const int delay_ticks : {0, 1, 5}) {
    RendererSettings settings;
    settings.profile.delay_ticks = delay_ticks;
    RendererFixture stage(settings, nullptr, 3.0);
    (void)stage.run(1000);
    const double ahead_s = 1e-3 * (delay_ticks + kPredictionMargin_ticks);
    for (int i = 0; i < 2000; ++i) {
      const TickReport& report = stage.step();
      const double time_s = toSeconds(report.play_time.time_since_epoch()) + ahead_s;
      // 19 mm/s at most: a scene at play time would be wrong by 0.04 to 0.13 mm.
      EXPECT_NEAR(report.object_position_mm.z(), 12.0 + 3.0 * std::sin(2.0 * M_PI * time_s), 0.005);
    }
  }
}

TEST(HapticRenderer, StopRampsToZeroAndStaysThere) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  RendererFixture stage({}, &hand);
  (void)stage.run(3000);
  stage.renderer->stop();
  EXPECT_EQ(stage.run(40).force_N, Vec3(Vec3::Zero()));
  EXPECT_EQ(stage.run(1000).force_N, Vec3(Vec3::Zero()));
  EXPECT_EQ(stage.max_excess_N, 0.0);
}

TEST(HapticRenderer, TheSameTicksGiveTheSameBits) {
  for (const Method method : {Method::kHapticast, Method::kThesis}) {
    std::vector<std::uint64_t> bits[2];
    for (auto& run : bits) {
      RendererSettings settings;
      settings.method = method;
      HandScript hand{HandKind::kSlide, HandStiffness{}};
      RendererFixture stage(settings, &hand, 3.0);
      for (int i = 0; i < 4000; ++i) {
        if (i == 3000) stage.newEpoch();
        const TickReport& report = stage.step();
        for (int k = 0; k < 3; ++k) {
          run.push_back(std::bit_cast<std::uint64_t>(report.force_N[k]));
          run.push_back(std::bit_cast<std::uint64_t>(report.hip_mm[k]));
        }
      }
      EXPECT_GT(stage.max_force_N, 0.2);
      EXPECT_EQ(stage.max_excess_N, 0.0);
    }
    EXPECT_EQ(bits[0], bits[1]);
  }
}

}  // namespace
}  // namespace hapticast::client
