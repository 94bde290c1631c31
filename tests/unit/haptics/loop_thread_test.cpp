// SPDX-License-Identifier: MIT
#include "client/device/loop/loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <thread>
#include <vector>

#include "tests/support/renderer_fixture.hpp"
#include "tests/support/scripted_device.hpp"
#include "tests/support/waiting.hpp"

namespace hapticast::client {
namespace {

/// A dome under a following hand, in virtual time but on a real thread, as fast as it goes.
struct Threaded {
  Threaded() : stage({}, &kFollower) {
    device.wait = [this](LocalTime deadline) {
      if (deadline > stage.clock.now()) stage.clock.advance(deadline - stage.clock.now());
      stage.receive();
    };
    device.answer = [this](const Vec3& force_N) {
      DeviceState state = stage.device.exchange(force_N, stage.renderer->report());
      if (lost) state.status = DeviceStatus::kLost;
      pushes = force_N.norm() > 0.2;
      ++ticks;
      return state;
    };
  }
  static void waitFor(const std::function<bool()>& what) {
    ASSERT_TRUE(waitUntil(std::chrono::seconds(60), what));
  }

  inline static const HandScript kFollower{HandKind::kFollow, HandStiffness{}};
  RendererFixture stage;
  ScriptedDevice device;
  std::atomic<bool> pushes{false};
  std::atomic<bool> lost{false};
  std::atomic<int> ticks{0};
};

TEST(LoopThread, StopRampsToZeroAndCountsStay) {
  Threaded on;
  LoopThread loop(on.device, *on.stage.renderer, on.stage.clock);
  on.waitFor([&] { return on.pushes.load(); });
  loop.stop();
  const int ticks = on.ticks;
  EXPECT_EQ(on.device.forces_N.back(), Vec3(Vec3::Zero()));
  EXPECT_EQ(static_cast<int>(loop.stats().ticks) + 1, ticks);
  EXPECT_EQ(loop.stats().step_excess_max_N, 0.0);
  loop.stop();
  EXPECT_EQ(on.ticks, ticks);
}

TEST(LoopThread, AnExceptionInTheOwnersScopeEndsForceAndThread) {
  Threaded on;
  const auto touchAndThrow = [&] {
    const LoopThread loop(on.device, *on.stage.renderer, on.stage.clock);
    on.waitFor([&] { return on.pushes.load(); });
    throw std::bad_alloc();
  };
  EXPECT_THROW(touchAndThrow(), std::bad_alloc);
  const std::vector<Vec3>& forces_N = on.device.forces_N;
  EXPECT_EQ(forces_N.back(), Vec3(Vec3::Zero()));
  const auto acted = std::find_if(forces_N.rbegin(), forces_N.rend(),
                                  [](const Vec3& force_N) { return force_N != Vec3::Zero(); });
  EXPECT_LT(acted->norm(), 0.11) << "it ramped down";
  const int ticks = on.ticks;
  restBetweenTurns(std::chrono::milliseconds(20));  // a thread that still ran would tick meanwhile
  EXPECT_EQ(on.ticks, ticks) << "nobody ticks any more";
}

TEST(LoopThread, ALostDeviceThatIsBackWaitsForTheUsersDoor) {
  Threaded on;
  auto log = std::make_unique<HapticRenderer::Log>();
  on.stage.renderer = std::make_unique<HapticRenderer>(on.stage.settings, on.stage.pool,
                                                       on.stage.stream, on.stage.user, log.get());
  TickReport last;
  const auto newest = [&] {
    while (log->tryPop(last)) {
    }
    return last;
  };
  LoopThread loop(on.device, *on.stage.renderer, on.stage.clock);
  on.waitFor([&] { return on.pushes.load(); });
  on.lost = true;
  on.waitFor([&] { return newest().device == DeviceStatus::kLost; });
  EXPECT_FALSE(deviceIsBack(last));
  on.lost = false;
  on.waitFor([&] { return deviceIsBack(newest()); });
  const int back = on.ticks;
  on.waitFor([&] { return on.ticks > back + 1000; });
  EXPECT_FALSE(on.pushes) << "no force until somebody asks for it";
  on.stage.user.store({.rearm = 1});
  // The log keeps no report while it is full, so its reader goes on.
  on.waitFor([&] { return newest().halt == Halt::kNone && on.pushes; });
  loop.stop();
  EXPECT_EQ(loop.stats().step_excess_max_N, 0.0);
}

TEST(LoopThread, FlushesDenormals) {
  Threaded on;
  volatile double smallest = std::numeric_limits<double>::min();
  std::atomic<double> half{-1.0};
  on.device.answer = [&](const Vec3&) {
    half = smallest * 0.5;
    return DeviceState{};
  };
  LoopThread loop(on.device, *on.stage.renderer, on.stage.clock);
  on.waitFor([&] { return half >= 0.0; });
  loop.stop();
  EXPECT_EQ(half, 0.0);
  EXPECT_GT(smallest * 0.5, 0.0) << "on that thread only";
}

/// The filters decay for ever: flushed, they end above the denormals, at the rounding of a count.
TEST(LoopThread, ATipAtRestMeetsNoDenormal) {
  std::thread([] {
    flushDenormals();
    HipEstimator motion(DeviceProfile{});
    DeviceState state;
    const HipEstimate* hip = nullptr;
    for (int i = 0; i < 10'000; ++i) {
      state.time += kTickPeriod;
      state.position_mm.x() = i < 10 ? 0.055 * i : 0.55;
      hip = &motion.update(state);
      for (int k = 0; k < 3; ++k) {
        ASSERT_NE(std::fpclassify(hip->acceleration_m_s2[k]), FP_SUBNORMAL) << "tick " << i;
      }
    }
    EXPECT_LT(hip->acceleration_m_s2.cwiseAbs().maxCoeff(), 1e-12);
  }).join();
}

}  // namespace
}  // namespace hapticast::client
