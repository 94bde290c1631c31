// SPDX-License-Identifier: MIT
// Streams that attack the renderer, as rows of a table. Each row meets every renderer: its force at
// a still hand has no step at any tick (Attack), and it ends as the row expects.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/scenes/false_streams/renderer_attack.hpp"

namespace hapticast::client {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();

struct AttackRow {
  std::string name;
  std::function<void(Attack&)> run;
  double tip_height_mm = 8.0;
};

void changeEpochsIdsAndHoles(Attack& attack) {
  attack.showPlate(10.0);
  EXPECT_GT(attack.run(1500).force_N.z(), 0.3);
  for (int i = 0; i < 6; ++i) {  // another plate in a new epoch every 0.5 s
    ++attack.epoch;
    attack.showPlate(i % 2 == 0 ? 9.0 : 13.0);
    (void)attack.run(500);
  }
  attack.scene = [&](PlayFrame& frame, double) {  // a new id every frame
    attack.add(frame, plateAt(10.0, static_cast<std::uint32_t>(frame.id)));
  };
  (void)attack.run(500);
  attack.scene = [&](PlayFrame& frame, double) {  // gone every third frame
    if (frame.id % 3 != 0) attack.add(frame, plateAt(10.0));
  };
  (void)attack.run(1000);
  attack.scene = [&](PlayFrame& frame, double) {  // without a relief every third frame
    attack.add(frame, plateAt(10.0));
    if (frame.id % 3 == 0) frame.objects[0].field = nullptr;
  };
  (void)attack.run(1000);
}

void letAPlateAppear(Attack& attack, double above_mm) {
  (void)attack.run(500);
  attack.showPlate(8.0 + above_mm);
  const DeviceProfile& profile = attack.settings.profile;
  const double scale = DeviceMapping::fit(Workspace{}, profile.workspace_mm).scale;
  const TickReport& report = attack.run(1000);
  if (above_mm * scale > std::max(2.0, profile.peak_N / profile.stiffness_N_mm)) {
    EXPECT_EQ(attack.max_force_N, 0.0);
  } else {
    EXPECT_GT(report.force_N.norm(), 0.1);
    // It fades in: the chain's way, or with the proxy's 40 ms.
    EXPECT_LT(attack.max_step_N, std::max(0.1, profile.stiffness_N_mm * above_mm * scale / 39.0));
  }
}

void swapWhichIsDeepest(Attack& attack) {
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

void changeTheStiffness(Attack& attack) {
  static constexpr double kValues[] = {0.05, 10.0, 0.3,       1e9, 1e-9, -1.0,
                                       kNaN, 0.5,  kInfinity, 2.0, 0.0};
  attack.scene = [&](PlayFrame& frame, double) {
    attack.add(frame, plateAt(10.0));
    frame.objects[0].material.stiffness_N_mm = kValues[frame.id / 5 % std::size(kValues)];
  };
  (void)attack.run(6000);
  EXPECT_GT(attack.max_force_N, 0.3);
}

/// The stream states a velocity, but the object rests: every extrapolation is off by up to 72 mm.
void correctAnExtrapolationLate(Attack& attack, double speed_mm_s) {
  attack.streaming = false;
  double sent_s = attack.next_s;
  attack.scene = [&attack, speed_mm_s](PlayFrame& frame, double) {
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

/// It does not keep old data alive.
void sendAFrameOfAnotherTime(Attack& attack, std::int64_t when_ns) {
  attack.showPlate(10.0);
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
}

/// The lookup and the force `age_s` after the newest frame.
void expectStale(const TickReport& report, double age_s) {
  if (age_s > 0.0 && std::abs(age_s - 0.08) > 1e-6 && std::abs(age_s - 0.3) > 1e-6) {
    const Lookup expected = age_s <= 0.08    ? Lookup::kExtrapolated
                            : age_s <= 0.300 ? Lookup::kHeld
                                             : Lookup::kStale;
    ASSERT_EQ(report.lookup, expected) << age_s;
  }
  if (age_s > 0.402) {
    ASSERT_EQ(report.force_N, Vec3(Vec3::Zero())) << age_s;
  }
}

/// It fades to exactly zero and comes back by depth.
void goStaleAndComeBack(Attack& attack, double above_mm) {
  attack.showPlate(9.5);
  EXPECT_GT(attack.run(1000).force_N.norm(), 0.1);
  attack.streaming = false;
  const double newest_s = attack.next_s - 0.04;
  const auto ahead = (attack.settings.profile.delay_ticks + kPredictionMargin_ticks) * kTickPeriod;
  for (int i = 0; i < 1000; ++i) {
    const TickReport& report = attack.step();
    const MediaTime scene_time = report.play_time + ahead;
    ASSERT_NO_FATAL_FAILURE(
        expectStale(report, toSeconds(scene_time.time_since_epoch()) - newest_s));
  }
  attack.showPlate(8.0 + above_mm);  // it goes on, at once
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

/// The stream's state is absurd for a while; after a new connection the force is back.
void surviveAState(Attack& attack, void (*change)(StreamTiming&)) {
  attack.showPlate(10.0);
  (void)attack.run(700);
  const StreamTiming good = attack.control;
  change(attack.control);
  (void)attack.run(400);
  attack.control = good;
  attack.control.first_epoch = ++attack.epoch;  // a new connection: its clock starts over
  EXPECT_GT(attack.run(1200).force_N.norm(), 0.2);
}

constexpr void (*kAbsurdStates[])(StreamTiming&) = {
    [](StreamTiming& c) { c.workspace.width_mm = 0.0; },
    [](StreamTiming& c) { c.workspace.width_mm = kNaN; },
    [](StreamTiming& c) { c.workspace.height_mm = kInfinity; },
    [](StreamTiming& c) { c.workspace.depth_mm = -kInfinity; },
    [](StreamTiming& c) { c.workspace.width_mm = c.workspace.height_mm = 1e-300; },
    [](StreamTiming& c) { c.workspace.width_px = c.workspace.height_px = 0; },
    [](StreamTiming& c) { c.workspace.width_px = 1; },
    [](StreamTiming& c) { c.workspace.stretch = true; },
    [](StreamTiming& c) { c.frame_interval = Duration(0); },
    [](StreamTiming& c) { c.frame_interval = Duration(kMost); },
    [](StreamTiming& c) { c.frame_interval = Duration(kLeast); },
    [](StreamTiming& c) { c.clock_offset = Duration(kMost); },
    [](StreamTiming& c) { c.clock_offset = Duration(kLeast); },
    [](StreamTiming& c) { c.pipeline_latency = Duration(kLeast); },
    [](StreamTiming& c) { c.playout_delay_target = Duration(kMost); },
    [](StreamTiming& c) { c.playout_delay_target = Duration(kLeast); },
    [](StreamTiming& c) { c.largest_acceleration_mm_s2 = 1e-300; },
    [](StreamTiming& c) { c.author_mass_kg = 1e300; },
    [](StreamTiming& c) { c.first_epoch = 1000; },
};

std::vector<AttackRow> listAttacks() {
  std::vector<AttackRow> rows = {{"EpochsIdsAndHolesInContact", changeEpochsIdsAndHoles},
                                 {"TwoObjectsThatSwapWhichIsDeepest", swapWhichIsDeepest},
                                 {"StiffnessFromTheStream", changeTheStiffness}};
  const auto add = [&](const char* name, auto run, const auto& values, double tip_mm = 8.0) {
    int number = 0;
    for (const auto& value : values)
      rows.push_back({name + std::string("_") + std::to_string(++number),
                      [run, value](Attack& attack) { run(attack, value); }, tip_mm});
  };
  add("APlateThatAppearsAboveTheTip", letAPlateAppear, std::vector{1.0, 3.0, 20.0});
  add("LateFramesThatCorrectAnExtrapolation", correctAnExtrapolationLate,
      std::vector{60.0, 300.0, 900.0}, 5.0);
  add("AFrameOfTheFarFutureOrPast", sendAFrameOfAnotherTime,
      std::vector<std::int64_t>{kMost, kMost / 2, 60'000'000'000, 0, kLeast});
  add("AStaleStreamThatComesBack", goStaleAndComeBack, std::vector{1.5, 25.0});
  add("AnAbsurdStreamState", surviveAState, kAbsurdStates);
  return rows;
}

class RendererAttack : public ::testing::TestWithParam<AttackRow> {};

TEST_P(RendererAttack, KeepsItsBoundsWithEachRenderer) {
  for (const RendererSettings& settings : listRendererSettings()) {
    Attack attack(settings, GetParam().tip_height_mm);
    attack.name = GetParam().name;
    GetParam().run(attack);
    if (HasFatalFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, RendererAttack, ::testing::ValuesIn(listAttacks()),
                         [](const auto& row) { return row.param.name; });

TEST(RendererAttackSurfaces, ADeepObjectThatVanishesLetsTheForceRampDown) {
  for (const SurfaceKind surface :
       {SurfaceKind::kProxy, SurfaceKind::kNormal, SurfaceKind::kPerturbed}) {
    RendererSettings renderer;
    renderer.surface = surface;
    Attack attack(renderer);
    attack.showPlate(13.0);
    const double before_N = attack.run(1500).force_N.norm();
    EXPECT_GT(before_N, 2.0);
    attack.scene = [](PlayFrame&, double) {};
    attack.max_step_N = 0.0;
    EXPECT_EQ(attack.run(300).force_N, Vec3(Vec3::Zero()));
    EXPECT_LE(attack.max_step_N, renderer.profile.residue_N_per_tick + 1e-9);
  }
}

}  // namespace
}  // namespace hapticast::client
