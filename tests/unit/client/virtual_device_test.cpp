// SPDX-License-Identifier: MIT
// Where a spring turns unstable on the device is measured by hapticast-evaluate stability (theory).
#include "client/device/virtual/virtual_device.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "client/haptics/tick_report.hpp"
#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {
namespace {

constexpr Duration kMs{1'000'000};

PlantProfile ideal(double damping_Ns_m, int delay_ticks) {
  PlantProfile profile;
  profile.damping_Ns_m = damping_Ns_m;
  profile.delay_ticks = delay_ticks;
  profile.count_mm = 0.0;
  return profile;
}

TEST(VirtualDevice, FreeFallAgainstDampingIsTheClosedForm) {
  ManualClock clock;
  VirtualDevice device(ideal(0.5, 0), Hand::none(), clock);
  device.reset(Vec3::Zero(), Vec3::Zero());
  for (int i = 0; i < 300; ++i) {
    clock.advance(kMs);
    (void)device.exchange({1.0, 0.0, 0.0}, {});
  }
  const double tau = 0.045 / 0.5;
  const double t = 0.3;
  EXPECT_NEAR(device.trueVelocity_mm_s().x(), 2000.0 * (1.0 - std::exp(-t / tau)), 1e-6);
  EXPECT_NEAR(device.truePosition_mm().x(), 2000.0 * (t - tau * (1.0 - std::exp(-t / tau))), 1e-6);
}

TEST(VirtualDevice, ForceActsAfterTheDelay) {
  for (int d = 0; d <= 5; ++d) {
    ManualClock clock;
    VirtualDevice device(ideal(0.1, d), Hand::none(), clock);
    device.reset(Vec3::Zero(), Vec3::Zero());
    int first = -1;
    for (int i = 0; i < 10 && first < 0; ++i) {
      clock.advance(kMs);
      if (device.exchange({0.0, 1.0, 0.0}, {}).position_mm.y() > 0.0) first = i;
    }
    EXPECT_EQ(first, d);
  }
}

TEST(VirtualDevice, PositionsComeInCounts) {
  ManualClock clock;
  VirtualDevice device(PlantProfile{}, Hand::none(), clock);
  device.reset({0.0, 0.0, 0.1}, {0.0, 0.0, 50.0});
  for (int i = 0; i < 100; ++i) {
    clock.advance(kMs);
    const double counts = device.exchange(Vec3::Zero(), {}).position_mm.z() / 0.055;
    EXPECT_NEAR(counts, std::round(counts), 1e-9);
  }
}

TEST(VirtualDevice, FrictionHoldsUntilItIsOvercome) {
  PlantProfile profile = ideal(0.1, 0);
  profile.friction_N = 0.26;
  ManualClock clock;
  VirtualDevice device(profile, Hand::none(), clock);
  device.reset(Vec3::Zero(), Vec3::Zero());
  const auto push = [&](double force_N, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      clock.advance(kMs);
      (void)device.exchange({0.0, 0.0, force_N}, {});
    }
    return device.truePosition_mm().z();
  };
  EXPECT_EQ(push(0.25, 500), 0.0);
  EXPECT_EQ(push(-0.25, 500), 0.0);
  const double slid = push(0.36, 100);
  EXPECT_NEAR(slid, 0.5 * 0.1 / 0.045 * 0.01 * 1e3, 1.0);  // 0.1 N left over
  (void)push(0.0, 1000);  // comes to rest by friction and stays exactly there
  const double rest = device.truePosition_mm().z();
  EXPECT_EQ(device.trueVelocity_mm_s().z(), 0.0);
  EXPECT_EQ(push(0.2, 500), rest);
}

TEST(VirtualDevice, CoulombStopMatchesTheClosedForm) {
  // No damping: v² / (2 fc/m) until it stops, exactly, wherever in a tick that is.
  PlantProfile profile = ideal(0.0, 0);
  profile.friction_N = 0.1;
  ManualClock clock;
  VirtualDevice device(profile, Hand::none(), clock);
  device.reset(Vec3::Zero(), {0.0, 0.0, 123.4});
  for (int i = 0; i < 200; ++i) {
    clock.advance(kMs);
    (void)device.exchange(Vec3::Zero(), {});
  }
  EXPECT_NEAR(device.truePosition_mm().z(), 0.5 * 0.1234 * 0.1234 / (0.1 / 0.045) * 1e3, 1e-9);
}

TEST(VirtualDevice, EveryHandSettlesAtItsTarget) {
  for (const Hand& hand : {Hand::light(), Hand::lightGrip(), Hand::firm(), Hand::firmGrip()}) {
    ManualClock clock;
    VirtualDevice device(ideal(0.1, 1), hand, clock);
    device.setTarget({5.0, -3.0, 12.0});
    for (int i = 0; i < 4000; ++i) {
      clock.advance(kMs);
      (void)device.exchange(Vec3::Zero(), {});
    }
    EXPECT_LT((device.truePosition_mm() - Vec3(5.0, -3.0, 12.0)).norm(), 1e-3);
    // 1 N moves it by the springs it is held with.
    for (int i = 0; i < 4000; ++i) {
      clock.advance(kMs);
      (void)device.exchange({0.0, 0.0, 1.0}, {});
    }
    const double soft_mm = 1e3 / hand.stiffness_N_m + (hand.grip_N_m > 0 ? 1e3 / hand.grip_N_m : 0);
    EXPECT_NEAR(device.truePosition_mm().z() - 12.0, soft_mm, 1e-3);
  }
}

TEST(VirtualDevice, LivesThroughLostTicks) {
  // The same force, called every tick and called every 10th: the same way.
  const auto run = [](int every) {
    ManualClock clock;
    VirtualDevice device(ideal(0.1, 1), Hand::light(), clock);
    device.reset(Vec3::Zero(), Vec3::Zero());
    clock.advance(kMs);
    DeviceState state = device.exchange(Vec3::Zero(), {});
    for (int i = 0; i < 100; i += every) {
      clock.advance(every * kMs);
      state = device.exchange({0.0, 0.0, 1.0}, {});
    }
    EXPECT_EQ(state.time, localTime(1.101));
    return state.position_mm.z();
  };
  EXPECT_NEAR(run(10), run(1), 1e-9);
  EXPECT_GT(run(1), 0.5);
}

TEST(VirtualDevice, AnEarlyOrLateWakeupIsOneTick) {
  ManualClock clock;
  VirtualDevice device(ideal(0.1, 1), Hand::light(), clock);
  clock.advance(kMs);
  LocalTime last = device.exchange(Vec3::Zero(), {}).time;
  for (const int us : {900, 1100, 1000, 1400, 600, 1300, 700}) {
    clock.advance(Duration(us * 1000));
    const LocalTime time = device.exchange(Vec3::Zero(), {}).time;
    EXPECT_EQ(time - last, kMs) << us;
    last = time;
  }
  clock.advance(std::chrono::hours(1));  // a suspended machine: bounded work
  EXPECT_EQ(device.exchange(Vec3::Zero(), {}).time, clock.now());
}

}  // namespace
}  // namespace hapticast::client
