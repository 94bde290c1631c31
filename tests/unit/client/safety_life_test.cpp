// SPDX-License-Identifier: MIT
// Minutes of random life with everything that can go wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "tests/unit/client/rig.hpp"

namespace hapticast::client {
namespace {

// --------------------------------------------------------------------------------------------------------

/// Minutes of everything at once; returns the last position, so that two lives can be compared bit
/// for bit.
Vec3 life(unsigned seed, const Hand& hand, int ticks) {
  const DeviceProfile profile = omni(1.0, 1, 0.05);
  Rig rig(profile, profile, hand);
  std::mt19937_64 random(seed);
  const auto chance = [&](double p) {
    return std::uniform_real_distribution(0.0, 1.0)(random) < p;
  };
  const auto between = [&](double a, double b) {
    return std::uniform_real_distribution(a, b)(random);
  };
  Vec3 target(0.0, 0.0, 10.0);
  Vec3 goal = target;
  double speed = 0.2;
  double from = 0.0;
  double to = 0.0;
  int stale = 0;
  int nan = 0;
  for (int i = 0; i < ticks; ++i) {
    if (i % 500 == 0) {
      goal = {between(-20, 20), between(-20, 20), between(-15, 15)};
      speed = chance(0.02) ? 2.0 : between(0.05, 0.5);
    }
    const Vec3 way = goal - target;
    if (way.norm() > 0.0) target += way * std::min(1.0, speed / way.norm());
    rig.device.setTarget(target + Vec3(0, 0, 0.3 * std::sin(0.0628 * i)));
    if (i % 40 == 0) {
      from = to;
      to = chance(0.9) ? std::clamp(to + between(-3, 3), -10.0, 10.0) : to;
    }
    const double s = (i % 40) / 40.0;
    rig.wall_mm = from + (to - from) * s * s * (3 - 2 * s);
    rig.wall_velocity_mm_s = (to - from) * 6 * s * (1 - s) / 0.04;
    if (chance(1e-4)) to = from = between(-15, 25), rig.epoch_jump = true;  // seek
    if (chance(5e-5)) to = from = between(-15, 25);                         // clock jump
    if (stale == 0 && chance(1e-4)) stale = static_cast<int>(between(200, 800));
    if (nan == 0 && chance(1e-4)) nan = static_cast<int>(between(1, 10));
    rig.touchable = stale == 0;
    rig.nan_heights = nan > 0;
    rig.blind = nan == 3;
    stale -= stale > 0;
    nan -= nan > 0;
    rig.dynamic_N = {between(-.1, .1), between(-.1, .1), chance(0.002) ? 2.0 : between(-.3, .3)};
    const bool late = chance(1e-4);
    rig.step(late ? Duration(static_cast<std::int64_t>(chance(0.3) ? 200e6 : between(1e6, 10e6)))
                  : Duration(1'000'000));
  }
  EXPECT_TRUE(rig.finite);
  EXPECT_LE(rig.max_force_N, profile.peak_N + 1e-9);
  EXPECT_EQ(rig.max_excess_N, 0.0);
  EXPECT_LE(rig.max_outer_excess_N, 1e-9);
  std::printf("life seed %u: %d s, peak %.2f N, step max %.2f N, excess %g N\n", seed, ticks / 1000,
              rig.max_force_N, rig.max_step_N, rig.max_excess_N);
  EXPECT_GT(rig.max_force_N, 1.0);
  return rig.device.truePosition_mm() + rig.out.force_N;
}

TEST(SafetyLife, LivesForMinutesWithoutAnUnexplainedStep) {
  (void)life(1, Hand::light(), 180'000);
  (void)life(2, Hand::firmGrip(), 180'000);
  (void)life(3, Hand::lightGrip(), 180'000);
}

TEST(SafetyLife, LivesTheSameLifeTwice) {
  EXPECT_EQ(life(7, Hand::lightGrip(), 20'000), life(7, Hand::lightGrip(), 20'000));
}

}  // namespace
}  // namespace hapticast::client
