// SPDX-License-Identifier: MIT
#include "client/haptics/playback/playout.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace hapticast::client {
namespace {

using std::chrono::milliseconds;

/// Exact, where localTime(seconds) rounds.
LocalTime localMs(int ms) { return LocalTime(milliseconds(ms)); }
MediaTime mediaMs(int ms) { return MediaTime(milliseconds(ms)); }

StreamTiming connected() {
  StreamTiming stream;
  stream.connected = true;
  stream.first_epoch = 1;
  stream.clock_offset = std::chrono::seconds(100);
  stream.pipeline_latency = milliseconds(120);
  stream.playout_delay_target = milliseconds(50);
  return stream;
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
  StreamTiming stream = connected();
  (void)playout.advance(localMs(1000), stream, false);
  stream.playout_delay_target = milliseconds(60);
  for (int tick = 1; tick <= 250; ++tick) (void)playout.advance(localMs(1000 + tick), stream, true);
  EXPECT_NEAR(toSeconds(playout.delay()), 0.055, 1e-6);
  stream.playout_delay_target = milliseconds(40);
  const MediaTime play = playout.advance(localMs(1251), stream, false);
  EXPECT_EQ(playout.delay(), milliseconds(40));
  EXPECT_EQ(play, mediaMs(101251) - milliseconds(160));
}

TEST(Playout, ALongerDelayWithoutContactStandsStillInsteadOfRunningBack) {
  Playout playout;
  StreamTiming stream = connected();
  const MediaTime before = playout.advance(localMs(1000), stream, false);
  stream.playout_delay_target = milliseconds(150);
  EXPECT_EQ(playout.advance(localMs(1001), stream, false), before);
  EXPECT_EQ(playout.advance(localMs(1090), stream, false), before);
  // Touching in the middle of it: on from here, at 98 % of the pace.
  const MediaTime touched = playout.advance(localMs(1091), stream, true);
  EXPECT_NEAR(toSeconds(touched - before), 0.98e-3, 1e-6);
  EXPECT_EQ(playout.advance(localMs(1200), stream, false), mediaMs(101200) - milliseconds(270));
  EXPECT_EQ(playout.delay(), milliseconds(150));
}

TEST(Playout, ANewConnectionStartsOver) {
  Playout playout;
  StreamTiming stream = connected();
  (void)playout.advance(localMs(1000), stream, true);
  stream.first_epoch = 2;
  stream.clock_offset = std::chrono::seconds(-5);  // a restarted server
  EXPECT_EQ(playout.advance(localMs(7000), stream, true), mediaMs(2000) - milliseconds(170));
}

TEST(Playout, PausedStandsStillAndGoesOnSmoothly) {
  Playout playout;
  StreamTiming stream = connected();
  const MediaTime before = playout.advance(localMs(1000), stream, true);
  for (int tick = 1; tick < 500; ++tick) {
    EXPECT_EQ(playout.advance(localMs(1000 + tick), stream, true, {.paused = true}), before);
  }
  EXPECT_NEAR(toSeconds(playout.advance(localMs(1500), stream, true) - before), 1.02e-3, 1e-6);
}

TEST(Playout, RejoiningStartsOverAsSoonAsThereIsAConnection) {
  Playout playout;
  StreamTiming stream = connected();
  const MediaTime before = playout.advance(localMs(1000), stream, true);
  for (int tick = 1; tick < 500; ++tick) {
    (void)playout.advance(localMs(1000 + tick), stream, true, {.paused = true});
  }
  playout.resync();
  stream.connected = false;
  EXPECT_LT(playout.advance(localMs(1500), stream, true) - before, milliseconds(2));
  stream.connected = true;
  EXPECT_EQ(playout.advance(localMs(1501), stream, true), mediaMs(101501) - milliseconds(170));
  EXPECT_EQ(playout.advance(localMs(1502), stream, true), mediaMs(101502) - milliseconds(170));
}

TEST(Playout, WithoutAConnectionItRunsOn) {
  Playout playout;
  StreamTiming stream = connected();
  const MediaTime before = playout.advance(localMs(1000), stream, false);
  stream.connected = false;
  stream.clock_offset = Duration{0};
  EXPECT_EQ(playout.advance(localMs(1100), stream, false) - before, milliseconds(100));
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
  StreamTiming stream = connected();
  MediaTime last = playout.advance(localMs(1000), stream, false);
  for (int tick = 1; tick <= 20000; ++tick) {
    if (tick % 37 == 0) stream.clock_offset = std::chrono::seconds(100) + Duration(wander(random));
    if (tick % 101 == 0)
      stream.playout_delay_target = milliseconds(50) + Duration(10 * wander(random));
    const MediaTime play = playout.advance(localMs(1000 + tick), stream, true);
    ASSERT_GE(toSeconds(play - last), 0.98e-3 - 1e-8);
    ASSERT_LE(toSeconds(play - last), 1.02e-3 + 1e-8);
    last = play;
  }
}

TEST(Playout, StartsOverWhenTheClockBecomesKnown) {
  // A connection is announced (new epoch, offset still 0) before its clock is known.
  Playout playout;
  StreamTiming stream = connected();
  const Duration offset = stream.clock_offset;
  stream.connected = false;
  stream.clock_offset = Duration{0};
  playout.advance(localMs(1000), stream, false);
  stream = connected();
  stream.clock_offset = offset - std::chrono::hours(1);  // far behind the local clock
  Playout fresh;
  EXPECT_EQ(playout.advance(localMs(1001), stream, false),
            fresh.advance(localMs(1001), stream, false));
}

TEST(Playout, IsMonotoneAtAnyTargetWithinAConnection) {
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
    StreamTiming stream;
    stream.first_epoch = 1;
    stream.connected = true;
    MediaTime last = playout.advance(LocalTime(any()), stream, false);
    for (int tick = 0; tick < 200; ++tick) {
      stream.connected = random() % 4 != 0;
      const UserControls user{.paused = random() % 8 == 0};
      stream.clock_offset = any();
      stream.pipeline_latency = any();
      stream.playout_delay_target = any();
      const MediaTime play = playout.advance(LocalTime(any()), stream, random() % 2 == 0, user);
      ASSERT_GE(play, last);
      last = play;
    }
  }
}

}  // namespace
}  // namespace hapticast::client
