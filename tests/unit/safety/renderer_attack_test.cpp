// SPDX-License-Identifier: MIT
// Streams that attack the renderer: the force at a still hand has no step.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/scenes/false_streams/renderer_attack.hpp"

namespace hapticast::client {
namespace {

TEST(RendererAttack, EpochsIdsAndHolesInContact) {
  for (const RendererSettings& renderer : listRendererSettings()) {
    Attack attack(renderer);
    attack.name = "a plate 2 mm above the tip";
    attack.scene = [&](PlayFrame& frame, double) { attack.add(frame, plateAt(10.0)); };
    EXPECT_GT(attack.run(1500).force_N.z(), 0.3);
    attack.name = "another plate in a new epoch every 0.5 s";
    for (int i = 0; i < 6; ++i) {
      ++attack.epoch;
      const double height_mm = i % 2 == 0 ? 9.0 : 13.0;
      attack.scene = [&attack, height_mm](PlayFrame& frame, double) {
        attack.add(frame, plateAt(height_mm));
      };
      (void)attack.run(500);
    }
    attack.name = "a new id every frame";
    attack.scene = [&](PlayFrame& frame, double) {
      attack.add(frame, plateAt(10.0, static_cast<std::uint32_t>(frame.id)));
    };
    (void)attack.run(500);
    attack.name = "gone every third frame";
    attack.scene = [&](PlayFrame& frame, double) {
      if (frame.id % 3 != 0) attack.add(frame, plateAt(10.0));
    };
    (void)attack.run(1000);
    attack.name = "without a relief every third frame";
    attack.scene = [&](PlayFrame& frame, double) {
      attack.add(frame, plateAt(10.0));
      if (frame.id % 3 == 0) frame.objects[0].field = nullptr;
    };
    (void)attack.run(1000);
  }
}

TEST(RendererAttack, ADeepObjectThatVanishesLetsTheForceRampDown) {
  for (const SurfaceKind surface :
       {SurfaceKind::kProxy, SurfaceKind::kNormal, SurfaceKind::kPerturbed}) {
    RendererSettings renderer;
    renderer.surface = surface;
    Attack attack(renderer);
    bool there = true;
    attack.scene = [&](PlayFrame& frame, double) {
      if (there) attack.add(frame, plateAt(13.0));
    };
    const double before_N = attack.run(1500).force_N.norm();
    EXPECT_GT(before_N, 2.0);
    there = false;
    attack.max_step_N = 0.0;
    EXPECT_EQ(attack.run(300).force_N, Vec3(Vec3::Zero()));
    EXPECT_LE(attack.max_step_N, renderer.profile.residue_N_per_tick + 1e-9);
  }
}

TEST(RendererAttack, AnObjectThatAppearsAboveTheTip) {
  for (const RendererSettings& renderer : listRendererSettings()) {
    for (const double above_mm : {1.0, 3.0, 20.0}) {
      Attack attack(renderer);
      attack.name = "appears";
      bool there = false;
      attack.scene = [&](PlayFrame& frame, double) {
        if (there) attack.add(frame, plateAt(8.0 + above_mm));
      };
      (void)attack.run(500);
      there = true;
      const double scale = DeviceMapping::fit(Workspace{}, renderer.profile.workspace_mm).scale;
      const TickReport& report = attack.run(1000);
      const double limit_mm =
          std::max(2.0, renderer.profile.peak_N / renderer.profile.stiffness_N_mm);
      if (above_mm * scale > limit_mm) {
        EXPECT_EQ(attack.max_force_N, 0.0);
      } else {
        EXPECT_GT(report.force_N.norm(), 0.1);
        // It fades in: the chain's way, or with the proxy's 40 ms.
        EXPECT_LT(attack.max_step_N,
                  std::max(0.1, renderer.profile.stiffness_N_mm * above_mm * scale / 39.0));
      }
    }
  }
}

TEST(RendererAttack, TwoObjectsThatSwapWhichIsDeepest) {
  for (const RendererSettings& renderer : listRendererSettings()) {
    Attack attack(renderer);
    attack.name = "opposite slopes";
    attack.scene = [&](PlayFrame& frame, double time_s) {
      const double by_mm = 0.4 * std::sin(9.0 * time_s);
      attack.add(frame, plateAt(11.0, 1, 1.0));
      attack.add(frame, plateAt(11.0, 2, -1.0));
      frame.objects[0].motion.position_mm.z() += by_mm;
      frame.objects[1].motion.position_mm.z() -= by_mm;
    };
    (void)attack.run(3000);
    EXPECT_GT(attack.max_force_N, 0.3);
  }
}

TEST(RendererAttack, StiffnessFromTheStream) {
  for (const RendererSettings& renderer : listRendererSettings()) {
    Attack attack(renderer);
    attack.name = "stiffness";
    const double values[] = {0.05, 10.0, 0.3, 1e9, 1e-9, -1.0, kNaN, 0.5, kInfinity, 2.0, 0.0};
    attack.scene = [&](PlayFrame& frame, double) {
      attack.add(frame, plateAt(10.0));
      frame.objects[0].material.stiffness_N_mm = values[frame.id / 5 % std::size(values)];
    };
    (void)attack.run(6000);
    EXPECT_GT(attack.max_force_N, 0.3);
  }
}

TEST(RendererAttack, LateFramesThatCorrectAnExtrapolation) {
  for (const RendererSettings& renderer : listRendererSettings()) {
    for (const double speed_mm_s : {60.0, 300.0, 900.0}) {
      Attack attack(renderer, 5.0);
      attack.name = "late correction";
      // It is said to move, but does not: every extrapolation is wrong by up to 72 mm.
      attack.streaming = false;
      double sent_s = attack.next_s;
      attack.scene = [&](PlayFrame& frame, double) {
        attack.add(frame, plateAt(7.0));
        frame.objects[0].motion.velocity_mm_s = {0.3 * speed_mm_s, 0.0, speed_mm_s};
      };
      for (int i = 0; i < 4000; ++i) {
        (void)attack.step();
        // Every frame arrives 20..79 ms after it is due.
        const double due_s =
            toSeconds(attack.clock.now().time_since_epoch()) - 0.08 - 0.02 * (i / 40 % 4);
        while (sent_s <= due_s) attack.publish(sent_s), sent_s += 0.04;
      }
    }
  }
}

TEST(RendererAttack, FramesOfTheFarFutureOrPastDoNotKeepOldDataAlive) {
  for (const RendererSettings& renderer : listRendererSettings()) {
    for (const std::int64_t when_ns :
         {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max() / 2,
          std::int64_t{60'000'000'000}, std::int64_t{0},
          std::numeric_limits<std::int64_t>::min()}) {
      Attack attack(renderer);
      attack.name = "a frame at " + std::to_string(when_ns);
      attack.scene = [&](PlayFrame& frame, double) { attack.add(frame, plateAt(10.0)); };
      (void)attack.run(1000);
      PlayFrame strange;
      strange.epoch = attack.epoch;
      strange.id = ++attack.id;
      strange.media_time = MediaTime(Duration(when_ns));
      attack.add(strange, plateAt(10.0));
      ASSERT_TRUE(send(attack.pool, strange));
      EXPECT_GT(attack.run(1000).force_N.norm(), 0.3);
      attack.streaming = false;  // 40 ms of frames, 80 of extrapolation, to 300 held, 100 of fade
      (void)attack.run(40 + 300 + 100 + 60);
      for (int i = 0; i < 1000; ++i) ASSERT_EQ(attack.step().force_N, Vec3(Vec3::Zero()));
      if (HasFatalFailure()) return;
    }
  }
}

TEST(RendererAttack, AStaleStreamFadesToExactlyZeroAndComesBackByDepth) {
  for (const RendererSettings& renderer : listRendererSettings()) {
    for (const double above_mm : {1.5, 25.0}) {
      Attack attack(renderer);
      attack.name = "stale";
      double height_mm = 9.5;
      attack.scene = [&](PlayFrame& frame, double) { attack.add(frame, plateAt(height_mm)); };
      EXPECT_GT(attack.run(1000).force_N.norm(), 0.1);
      attack.streaming = false;
      const double newest_s = attack.next_s - 0.04;
      for (int i = 0; i < 1000; ++i) {
        const TickReport& report = attack.step();
        const MediaTime scene_time =
            report.play_time +
            (renderer.profile.delay_ticks + kPredictionMargin_ticks) * kTickPeriod;
        const double age_s = toSeconds(scene_time.time_since_epoch()) - newest_s;
        if (age_s > 0.0) {
          const Lookup expected = age_s <= 0.08    ? Lookup::kExtrapolated
                                  : age_s <= 0.300 ? Lookup::kHeld
                                                   : Lookup::kStale;
          if (std::abs(age_s - 0.08) > 1e-6 && std::abs(age_s - 0.3) > 1e-6) {
            ASSERT_EQ(report.lookup, expected) << age_s;
          }
        }
        if (age_s > 0.402) {
          ASSERT_EQ(report.force_N, Vec3(Vec3::Zero())) << age_s;
        }
      }
      height_mm = 8.0 + above_mm;  // it goes on, at once
      attack.streaming = true;
      attack.max_force_N = attack.max_step_N = 0.0;
      const TickReport& report = attack.run(1000);
      if (above_mm > 20.0) {
        EXPECT_EQ(attack.max_force_N, 0.0);  // deep: unarmed until the hand has left
      } else {
        EXPECT_GT(report.force_N.norm(), 0.1);
        EXPECT_LT(attack.max_step_N, 0.1);
      }
    }
  }
}

}  // namespace
}  // namespace hapticast::client
