// SPDX-License-Identifier: MIT
// Simulated networks: the media clock is offset + (1 + drift) x local; every way has a fixed part
// and a random queue.
#include "common/transport/clock_sync.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace hapticast {
namespace {

constexpr double kStart_s = 1000.0;

struct Network {
  double offset_s = 12345.678;
  double drift = 0.0;
  double up_s = 0.010;
  double down_s = 0.010;
  double queue_s = 0.0;  // mean of the exponential queues of each way
  std::mt19937 random{1};

  [[nodiscard]] double media(double local_s) const {
    return local_s + offset_s + drift * (local_s - kStart_s);
  }
  double queue() {
    return queue_s > 0.0 ? std::exponential_distribution<double>(1.0 / queue_s)(random) : 0.0;
  }
  /// Pings at `local_s`; returns when the answer is there.
  double ping(ClockSync& sync, double local_s) {
    const double there = local_s + up_s + queue();
    const double back = there + 0.0001 + down_s + queue();
    sync.add(localTime(local_s), mediaTime(media(there)), mediaTime(media(there + 0.0001)),
             localTime(back));
    return back;
  }
  /// Error of the offset handed out, in seconds.
  [[nodiscard]] double error(ClockSync& sync, double local_s) const {
    return toSeconds(sync.offset(localTime(local_s))) - (media(local_s) - local_s);
  }
  double burst(ClockSync& sync, double local_s) {
    for (std::size_t i = 0; i < ClockSync::kBurst; ++i) local_s = ping(sync, local_s) + 0.02;
    return local_s;
  }
};

TEST(ClockSync, IsReadyAfterAFewPingsAndExactOnAQuietNetwork) {
  Network network;
  ClockSync sync;
  double now = kStart_s;
  for (std::size_t i = 0; i < ClockSync::kNeeded; ++i) {
    EXPECT_FALSE(sync.ready());
    now = network.ping(sync, now);
  }
  ASSERT_TRUE(sync.ready());
  EXPECT_NEAR(network.error(sync, now), 0.0, 1e-6);
  EXPECT_NEAR(toSeconds(sync.errorBound()), 0.010, 1e-6) << "half a round trip";
}

TEST(ClockSync, StaysWithinItsBoundAtAnyAsymmetry) {
  for (const auto& [up, down] : {std::pair{0.001, 0.030}, {0.030, 0.001}, {0.0, 0.050}}) {
    Network network;
    network.up_s = up;
    network.down_s = down;
    ClockSync sync;
    const double now = network.burst(sync, kStart_s);
    EXPECT_LE(std::abs(network.error(sync, now)), toSeconds(sync.errorBound()) + 1e-6);
    EXPECT_NEAR(std::abs(network.error(sync, now)), std::abs(up - down) / 2.0, 1e-5);
  }
}

TEST(ClockSync, ReplacesAnOffsetThatABetterPingRulesOutAtOnce) {
  Network network;
  network.up_s = 0.1;  // only at first
  ClockSync sync;
  double now = network.burst(sync, kStart_s);
  EXPECT_NEAR(std::abs(network.error(sync, now)), 0.045, 1e-3);
  network.up_s = network.down_s;
  for (int i = 0; i < 200; ++i) {
    network.ping(sync, now);
    now += 0.1;
    const double error = std::abs(network.error(sync, now));
    ASSERT_LE(error, toSeconds(sync.errorBound()) + 1e-6) << i;
  }
  EXPECT_LT(std::abs(network.error(sync, now)), 0.001) << "within the bound at 0.05 %";
}

TEST(ClockSync, TrustsThePingsThatWaitedInNoQueue) {
  Network network;
  network.queue_s = 0.020;
  ClockSync sync;
  double now = network.burst(sync, kStart_s);
  for (int i = 0; i < 200; ++i) {
    network.ping(sync, now);
    now += 1.0;
    (void)sync.offset(localTime(now));
  }
  EXPECT_LT(std::abs(network.error(sync, now)), 0.006) << "queues of 20 ms each way on average";
  EXPECT_LE(std::abs(network.error(sync, now)), toSeconds(sync.errorBound()));
}

TEST(ClockSync, FollowsADriftOf200MillisecondsAnHour) {
  for (const double sign : {1.0, -1.0}) {
    Network network;
    network.drift = sign * 0.2 / 3600.0;
    network.queue_s = 0.0005;
    ClockSync sync;
    double now = network.burst(sync, kStart_s);
    double worst = 0.0;
    for (int i = 0; i < 3600; ++i) {
      network.ping(sync, now);
      now += 1.0;
      const double error = std::abs(network.error(sync, now));
      if (i > 100) worst = std::max(worst, error);
    }
    EXPECT_LT(worst, 0.0004);
    // Without pings the line goes on: 20 s of this drift are 1.1 ms.
    for (int i = 0; i < 20; ++i) (void)network.error(sync, now += 1.0);
    EXPECT_LT(std::abs(network.error(sync, now)), 0.0006);
  }
}

TEST(ClockSync, HandsOutAnOffsetThatRunsNoFasterThanTheLimitUnlessAPingShowsMore) {
  Network network;
  network.queue_s = 0.030;
  ClockSync sync;
  double now = network.burst(sync, kStart_s);
  double next_ping = now;
  Duration last = sync.offset(localTime(now));
  int faster = 0;
  for (int tick = 0; tick < 60000; ++tick) {
    now += 0.001;
    const bool pinged = now >= next_ping;
    if (pinged) {
      network.ping(sync, now);
      next_ping += 1.0;
    }
    const Duration offset = sync.offset(localTime(now));
    if (std::abs((offset - last).count()) > 501) {  // 0.05 % of 1 ms, rounded
      EXPECT_TRUE(pinged);
      ++faster;
    }
    last = offset;
  }
  EXPECT_LT(faster, 20) << "of 60 pings";
}

TEST(ClockSync, AClockThatWasSetIsFollowed) {
  Network network;
  ClockSync sync;
  double now = network.burst(sync, kStart_s);
  for (const double by_s : {3.0, -7.0}) {
    network.offset_s += by_s;
    now = network.ping(sync, now + 1.0);
    EXPECT_NEAR(network.error(sync, now), 0.0, 1e-6) << by_s;
  }
}

TEST(ClockSync, IsExactWhereEachWayIsQuickNowAndThen) {
  Network network;  // of 16 pings hardly any is quick both ways
  network.up_s = network.down_s = 0.020;
  network.queue_s = 0.020;
  ClockSync sync;
  double now = network.burst(sync, kStart_s);
  for (int i = 0; i < 300; ++i) now = network.ping(sync, now + 1.0);
  EXPECT_LT(std::abs(network.error(sync, now)), 0.001);
}

TEST(ClockSync, ForgetsOutliersAndNonsense) {
  Network network;
  ClockSync sync;
  double now = network.burst(sync, kStart_s);
  const Duration before = sync.offset(localTime(now));
  // One answer held up for 2 s on its way back: asymmetric by a second.
  sync.add(localTime(now), mediaTime(network.media(now + 0.01)),
           mediaTime(network.media(now + 0.01)), localTime(now + 2.0));
  // A negative round trip, clocks that run backwards.
  sync.add(localTime(now), mediaTime(0), mediaTime(100), localTime(now + 0.1));
  sync.add(localTime(now), mediaTime(100), mediaTime(0), localTime(now + 0.1));
  sync.add(localTime(now), mediaTime(0), mediaTime(0), localTime(now - 1));
  EXPECT_NEAR(toSeconds(sync.offset(localTime(now + 10)) - before), 0.0, 1e-6);
}

TEST(ClockSync, ResetStartsOverAtOnce) {
  Network network;
  ClockSync sync;
  double now = network.burst(sync, kStart_s);
  (void)sync.offset(localTime(now));
  network.offset_s = -5.0;
  sync.reset();
  EXPECT_FALSE(sync.ready());
  now = network.burst(sync, now);
  EXPECT_NEAR(network.error(sync, now), 0.0, 1e-6) << "no slew from the old offset";
}

}  // namespace
}  // namespace hapticast
