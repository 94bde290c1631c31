// SPDX-License-Identifier: MIT
#include "client/device/loop/loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

#include "common/time.hpp"
#include "tests/support/renderer_fixture.hpp"
#include "tests/support/scripted_device.hpp"

namespace hapticast::client {
namespace {

/// A stage whose device moves the virtual clock while it waits; stops the loop after some ticks.
struct Looped {
  explicit Looped(const HandScript* hand) : stage({}, hand) {
    device.wait = [this](LocalTime deadline) {
      const Duration rest = deadline - stage.clock.now();
      stage.clock.advance(std::clamp(rest, Duration{0}, reply));
      const int tick = static_cast<int>(device.deadlines.size());
      if (tick == stall_at) stage.clock.advance(stall);
      if (tick == stop_at) stop = true;
      woken.push_back(stage.clock.now());
      stage.receive();
    };
    device.answer = [this](const Vec3& force_N) {
      return stage.device.exchange(force_N, stage.renderer->report());
    };
  }
  void run() { runLoop(device, *stage.renderer, stage.clock, stop, *stats); }

  RendererFixture stage;
  ScriptedDevice device;
  std::unique_ptr<LoopStats> stats = std::make_unique<LoopStats>();
  LocalTime base = stage.clock.now();
  std::vector<LocalTime> woken;
  std::atomic<bool> stop{false};
  int stop_at = 3000;
  int stall_at = -1;
  Duration stall{0};
  Duration reply = Duration::max();  ///< comes this long after the last wake-up
};

const HandScript kFollower{HandKind::kFollow, HandStiffness{}};

TEST(Loop, KeepsAMillisecondGridAndCounts) {
  Looped loop(&kFollower);
  loop.run();
  const LoopStats& stats = *loop.stats;
  for (std::size_t i = 0; i < loop.device.deadlines.size(); ++i) {
    ASSERT_EQ(loop.device.deadlines[i] - loop.base, static_cast<int>(i + 1) * kTickPeriod);
  }
  EXPECT_EQ(stats.late_ticks, 0u);
  EXPECT_EQ(stats.ticks, loop.device.deadlines.size());
  EXPECT_EQ(stats.tick_ns.count(), stats.ticks);
  EXPECT_EQ(stats.exchange_ns.count(), stats.ticks);
  EXPECT_GT(stats.contact_ticks, 1000u);
  EXPECT_GT(stats.max_force_N, 0.3);
  EXPECT_EQ(stats.step_excess_max_N, 0.0);
  EXPECT_GT(stats.lookup[static_cast<std::size_t>(Lookup::kInterpolated)], 2000u);
}

TEST(Loop, StopLeavesTheDeviceAtZeroWithoutAStep) {
  Looped loop(&kFollower);
  loop.run();
  const std::vector<Vec3>& forces_N = loop.device.forces_N;
  ASSERT_GT(forces_N[2990].norm(), 0.3) << "it was in contact when it was stopped";
  EXPECT_EQ(forces_N.back(), Vec3(Vec3::Zero()));
  EXPECT_LT(forces_N.size(), 3050u);
  for (std::size_t i = 3001; i < forces_N.size(); ++i) {
    EXPECT_LE((forces_N[i] - forces_N[i - 1]).norm(), 0.1 + 1e-9);
  }
  EXPECT_EQ(loop.stats->step_excess_max_N, 0.0);
}

TEST(Loop, StopsAtOnceWhenNoForceActs) {
  Looped loop(nullptr);
  loop.stop = true;
  loop.run();
  EXPECT_EQ(loop.stats->ticks, 1u);
}

TEST(Loop, AStallIsOneLateTickNotABurst) {
  Looped loop(&kFollower);
  loop.stall_at = 2000;
  loop.stall = Duration(57'300'000);
  loop.run();
  EXPECT_EQ(loop.stats->late_ticks, 1u);
  // The tick after the stall waits for the next point of the same grid.
  EXPECT_EQ(loop.device.deadlines[2000] - loop.base, 2058 * kTickPeriod);
  EXPECT_EQ(loop.device.deadlines[2001] - loop.base, 2059 * kTickPeriod);
  EXPECT_EQ(loop.stats->step_excess_max_N, 0.0);
}

TEST(Loop, ADeviceThatRepliesEarlyKeepsItsWatchdog) {
  Looped loop(nullptr);
  loop.reply = Duration(950'000);
  loop.stop_at = 60'000;
  loop.run();
  ASSERT_EQ(loop.woken.size(), loop.device.deadlines.size());
  for (std::size_t i = 1; i < loop.woken.size(); ++i) {
    ASSERT_EQ(loop.woken[i] - loop.woken[i - 1], loop.reply) << "it is the reply that wakes";
    ASSERT_EQ(loop.device.deadlines[i] - loop.woken[i - 1], kTickPeriod);
  }
  EXPECT_EQ(loop.stats->late_ticks, 0u);
}

TEST(Loop, AReplyThatStaysOutIsEndedByTheDeadlineOfThisVeryTick) {
  Looped loop(nullptr);
  loop.reply = Duration(950'000);
  loop.device.wait = [&, wait = loop.device.wait](LocalTime deadline) {
    loop.reply = loop.device.deadlines.size() == 2000 ? Duration::max() : Duration(950'000);
    wait(deadline);
  };
  loop.run();
  EXPECT_EQ(loop.woken[1999] - loop.woken[1998], kTickPeriod);
  EXPECT_EQ(loop.woken[2000] - loop.woken[1999], loop.reply);
}

}  // namespace
}  // namespace hapticast::client
