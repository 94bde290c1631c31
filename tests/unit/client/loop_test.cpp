// SPDX-License-Identifier: MIT
#include "client/haptics/loop.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "common/tick.hpp"
#include "tests/support/stage.hpp"

namespace hapticast::client {
namespace {

/// A virtual device whose waiting moves the virtual clock; stops the loop after a number of ticks.
class SteppedDevice final : public HapticDevice {
 public:
  explicit SteppedDevice(Stage& stage) : stage_(stage) {}
  [[nodiscard]] const DeviceProfile& profile() const noexcept override {
    return stage_.device.profile();
  }
  void waitForTick(LocalTime deadline) noexcept override {
    deadlines.push_back(deadline);
    if (deadline > stage_.clock.now()) stage_.clock.advance(deadline - stage_.clock.now());
    const int tick = static_cast<int>(deadlines.size());
    if (tick == stall_at) stage_.clock.advance(stall);
    if (tick == stop_at) stop = true;
    stage_.receive();
  }
  DeviceState exchange(const Vec3& force_N) noexcept override {
    forces.push_back(force_N);
    return stage_.device.exchange(force_N);
  }
  void observe(const TickReport& report) noexcept override { stage_.device.observe(report); }

  std::vector<LocalTime> deadlines;
  std::vector<Vec3> forces;
  std::atomic<bool> stop{false};
  int stop_at = 3000;
  int stall_at = -1;
  Duration stall{0};

 private:
  Stage& stage_;
};

TEST(Loop, KeepsAMillisecondGridAndCounts) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  Stage stage({}, &hand);
  SteppedDevice device(stage);
  auto stats = std::make_unique<LoopStats>();
  const LocalTime base = stage.clock.now();
  runLoop(device, *stage.room, stage.clock, device.stop, *stats);
  for (std::size_t i = 0; i < device.deadlines.size(); ++i) {
    ASSERT_EQ(device.deadlines[i] - base, static_cast<int>(i + 1) * kTickPeriod);
  }
  EXPECT_EQ(stats->late_ticks, 0u);
  EXPECT_EQ(stats->ticks, device.deadlines.size());
  EXPECT_EQ(stats->tick_ns.count(), stats->ticks);
  EXPECT_EQ(stats->exchange_ns.count(), stats->ticks);
  EXPECT_GT(stats->contact_ticks, 1000u);
  EXPECT_GT(stats->max_force_N, 0.3);
  EXPECT_EQ(stats->step_excess_max_N, 0.0);
  EXPECT_GT(stats->lookup[static_cast<std::size_t>(Lookup::kInterpolated)], 2000u);
}

TEST(Loop, StopLeavesTheDeviceAtZeroWithoutAStep) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  Stage stage({}, &hand);
  SteppedDevice device(stage);
  auto stats = std::make_unique<LoopStats>();
  runLoop(device, *stage.room, stage.clock, device.stop, *stats);
  ASSERT_GT(device.forces[2990].norm(), 0.3) << "it was in contact when it was stopped";
  EXPECT_EQ(device.forces.back(), Vec3(Vec3::Zero()));
  EXPECT_LT(device.forces.size(), 3050u);
  for (std::size_t i = 3001; i < device.forces.size(); ++i) {
    EXPECT_LE((device.forces[i] - device.forces[i - 1]).norm(), 0.1 + 1e-9);
  }
  EXPECT_EQ(stats->step_excess_max_N, 0.0);
}

TEST(Loop, StopsAtOnceWhenNoForceActs) {
  Stage stage({}, nullptr);
  SteppedDevice device(stage);
  device.stop = true;
  auto stats = std::make_unique<LoopStats>();
  runLoop(device, *stage.room, stage.clock, device.stop, *stats);
  EXPECT_EQ(stats->ticks, 1u);
}

TEST(Loop, AStallIsOneLateTickNotABurst) {
  HandScript hand{HandKind::kFollow, HandStiffness{}};
  Stage stage({}, &hand);
  SteppedDevice device(stage);
  device.stall_at = 2000;
  device.stall = Duration(57'300'000);
  auto stats = std::make_unique<LoopStats>();
  const LocalTime base = stage.clock.now();
  runLoop(device, *stage.room, stage.clock, device.stop, *stats);
  EXPECT_EQ(stats->late_ticks, 1u);
  // The tick after the stall waits for the next point of the same grid.
  EXPECT_EQ(device.deadlines[2000] - base, 2058 * kTickPeriod);
  EXPECT_EQ(device.deadlines[2001] - base, 2059 * kTickPeriod);
  EXPECT_EQ(stats->step_excess_max_N, 0.0);
}

}  // namespace
}  // namespace hapticast::client
