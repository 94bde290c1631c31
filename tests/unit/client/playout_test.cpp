// SPDX-License-Identifier: MIT
#include "client/haptics/time/playout.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace hapticast::client {
namespace {

using std::chrono::milliseconds;

/// Exact, where localTime(seconds) rounds.
LocalTime localMs(int ms) { return LocalTime(milliseconds(ms)); }
MediaTime mediaMs(int ms) { return MediaTime(milliseconds(ms)); }

Controls connected() {
  Controls controls;
  controls.connected = true;
  controls.first_epoch = 1;
  controls.clock_offset = std::chrono::seconds(100);
  controls.pipeline_latency = milliseconds(120);
  controls.playout_delay_target = milliseconds(50);
  return controls;
}

TEST(Playout, IsMediaClockMinusLatencyMinusDelay) {
  Playout playout;
  EXPECT_EQ(playout.advance(localMs(1000), connected(), false),
            mediaMs(101000) - milliseconds(170));
  EXPECT_EQ(playout.delay(), milliseconds(50));
  EXPECT_EQ(playout.advance(localMs(1001), connected(), true), mediaMs(101001) - milliseconds(170));
}

TEST(Playout, FollowsTheTargetAtTwoPercentInContactAndAtOnceWithout) {
  Playout playout;
  Controls controls = connected();
  (void)playout.advance(localMs(1000), controls, false);
  controls.playout_delay_target = milliseconds(60);
  for (int tick = 1; tick <= 250; ++tick)
    (void)playout.advance(localMs(1000 + tick), controls, true);
  EXPECT_NEAR(toSeconds(playout.delay()), 0.055, 1e-6);
  controls.playout_delay_target = milliseconds(40);
  const MediaTime play = playout.advance(localMs(1251), controls, false);
  EXPECT_EQ(playout.delay(), milliseconds(40));
  EXPECT_EQ(play, mediaMs(101251) - milliseconds(160));
}

TEST(Playout, ALongerDelayWithoutContactStandsStillInsteadOfRunningBack) {
  Playout playout;
  Controls controls = connected();
  const MediaTime before = playout.advance(localMs(1000), controls, false);
  controls.playout_delay_target = milliseconds(150);
  EXPECT_EQ(playout.advance(localMs(1001), controls, false), before);
  EXPECT_EQ(playout.advance(localMs(1090), controls, false), before);
  // Touching in the middle of it: on from here, at 98 % of the pace.
  const MediaTime touched = playout.advance(localMs(1091), controls, true);
  EXPECT_NEAR(toSeconds(touched - before), 0.98e-3, 1e-6);
  EXPECT_EQ(playout.advance(localMs(1200), controls, false), mediaMs(101200) - milliseconds(270));
  EXPECT_EQ(playout.delay(), milliseconds(150));
}

TEST(Playout, ANewConnectionStartsOver) {
  Playout playout;
  Controls controls = connected();
  (void)playout.advance(localMs(1000), controls, true);
  controls.first_epoch = 2;
  controls.clock_offset = std::chrono::seconds(-5);  // a restarted server
  EXPECT_EQ(playout.advance(localMs(7000), controls, true), mediaMs(2000) - milliseconds(170));
}

TEST(Playout, PausedStandsStillAndGoesOnSmoothly) {
  Playout playout;
  Controls controls = connected();
  const MediaTime before = playout.advance(localMs(1000), controls, true);
  controls.paused = true;
  for (int tick = 1; tick < 500; ++tick) {
    EXPECT_EQ(playout.advance(localMs(1000 + tick), controls, true), before);
  }
  controls.paused = false;
  EXPECT_NEAR(toSeconds(playout.advance(localMs(1500), controls, true) - before), 1.02e-3, 1e-6);
}

TEST(Playout, WithoutAConnectionItRunsOn) {
  Playout playout;
  Controls controls = connected();
  const MediaTime before = playout.advance(localMs(1000), controls, false);
  controls.connected = false;
  controls.clock_offset = Duration{0};
  EXPECT_EQ(playout.advance(localMs(1100), controls, false) - before, milliseconds(100));
}

TEST(Playout, AClockThatStandsOrRunsBackIsHarmless) {
  Playout playout;
  const MediaTime first = playout.advance(localMs(1000), connected(), true);
  EXPECT_EQ(playout.advance(localMs(1000), connected(), true), first);
  EXPECT_EQ(playout.advance(localMs(500), connected(), true), first);
  EXPECT_EQ(playout.advance(localMs(1001), connected(), true), first + milliseconds(1));
}

TEST(Playout, PaceStaysWithinTwoPercentUnderRandomTargetsInContact) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> wander(-3'000'000, 3'000'000);
  Playout playout;
  Controls controls = connected();
  MediaTime last = playout.advance(localMs(1000), controls, false);
  for (int tick = 1; tick <= 20000; ++tick) {
    if (tick % 37 == 0)
      controls.clock_offset = std::chrono::seconds(100) + Duration(wander(random));
    if (tick % 101 == 0)
      controls.playout_delay_target = milliseconds(50) + Duration(10 * wander(random));
    const MediaTime play = playout.advance(localMs(1000 + tick), controls, true);
    ASSERT_GE(toSeconds(play - last), 0.98e-3 - 1e-8);
    ASSERT_LE(toSeconds(play - last), 1.02e-3 + 1e-8);
    last = play;
  }
}

TEST(Playout, StartsOverWhenTheClockBecomesKnown) {
  // A connection is announced (new epoch, offset still 0) before its clock is known.
  Playout playout;
  Controls controls = connected();
  const Duration offset = controls.clock_offset;
  controls.connected = false;
  controls.clock_offset = Duration{0};
  playout.advance(localMs(1000), controls, false);
  controls = connected();
  controls.clock_offset = offset - std::chrono::hours(1);  // far behind the local clock
  Playout fresh;
  EXPECT_EQ(playout.advance(localMs(1001), controls, false),
            fresh.advance(localMs(1001), controls, false));
}

TEST(Playout, IsMonotoneWhateverIsAskedWithinAConnection) {
  std::mt19937_64 random(2);
  const auto any = [&] {
    constexpr std::int64_t kExtreme[] = {0, 1, -1, std::numeric_limits<std::int64_t>::max(),
                                         std::numeric_limits<std::int64_t>::min()};
    const std::uint64_t draw = random();
    return Duration(draw % 3 == 0 ? kExtreme[(draw >> 8) % 5]
                                  : static_cast<std::int64_t>(random()));
  };
  for (int run = 0; run < 100; ++run) {
    Playout playout;
    Controls controls;
    controls.first_epoch = 1;
    controls.connected = true;
    MediaTime last = playout.advance(LocalTime(any()), controls, false);
    for (int tick = 0; tick < 200; ++tick) {
      controls.connected = random() % 4 != 0;
      controls.paused = random() % 8 == 0;
      controls.clock_offset = any();
      controls.pipeline_latency = any();
      controls.playout_delay_target = any();
      const MediaTime play = playout.advance(LocalTime(any()), controls, random() % 2 == 0);
      ASSERT_GE(play, last);
      last = play;
    }
  }
}

}  // namespace
}  // namespace hapticast::client
