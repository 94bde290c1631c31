// SPDX-License-Identifier: MIT
// Trust in a stream: its loss, its report and its return.
#include "client/haptics/safety/trust.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "client/haptics/rearm_policy.hpp"
#include "client/report/messages.hpp"
#include "tests/support/chain_fixture.hpp"

namespace hapticast::client {
namespace {

constexpr std::uint32_t kTankBit = bit(SafetyAction::kTank);

TEST(Trust, IsLostToLastingActionsAndNotToShortOnes) {
  Trust lasting;
  int ticks = 0;
  for (; !lasting.lost() && ticks < 10000; ++ticks) lasting.add(kTankBit);
  EXPECT_NEAR(ticks, 210, 5) << "0.2 s of nothing but interference";
  Trust rare;  // a blow of 14 ticks twice a second, for a minute
  for (int i = 0; i < 60000; ++i) {
    rare.add(i % 500 < 14 ? bit(SafetyAction::kSlew) : 0);
    ASSERT_FALSE(rare.lost()) << i;
  }
  Trust often;  // a shake that is slowed in every seventh tick
  for (int i = 0; i < 60000; ++i) often.add(i % 7 == 0 ? bit(SafetyAction::kSlew) : 0);
  EXPECT_TRUE(often.lost());
}

TEST(Trust, CountsActionsThatOnlyAStreamCanCause) {
  using enum SafetyAction;
  for (std::size_t i = 0; i < kSafetyActionNames.size(); ++i) {
    const auto which = static_cast<SafetyAction>(i);
    const bool counts = which == kImplausible || which == kTank || which == kSlew ||
                        which == kSurfaceSpeed || which == kJump;
    Trust trust;
    for (int tick = 0; tick < 5000; ++tick) trust.add(bit(which), which == SafetyAction::kJump);
    EXPECT_EQ(trust.lost(), counts) << kSafetyActionNames[i];
    if (counts) {
      EXPECT_EQ(trust.findMostFrequent(), which);
    }
  }
}

TEST(Trust, AJumpCountsOnlyIfTheStreamCausedIt) {
  Trust trust;
  for (int tick = 0; tick < 5000; ++tick) trust.add(bit(SafetyAction::kJump), false);
  EXPECT_EQ(trust.score(), 0.0);
}

TEST(Trust, AClipThatStartsAgainEverySecondKeepsItAndAStrobeLosesIt) {
  for (const int period : {1000, 300}) {
    Trust trust;
    for (int tick = 0; tick < 20000; ++tick) trust.add(0, tick % period == 0);
    EXPECT_EQ(trust.lost(), period == 300) << period;
  }
}

TEST(Trust, SeveralInOneTickAreOne) {
  Trust trust;
  for (int i = 0; i < 150; ++i) trust.add(kTankBit | bit(SafetyAction::kSlew));
  EXPECT_FALSE(trust.lost());
  for (int i = 0; i < 100; ++i) trust.add(kTankBit);
  EXPECT_TRUE(trust.lost());
  EXPECT_EQ(trust.findMostFrequent(), SafetyAction::kTank);
  trust.renew();
  EXPECT_FALSE(trust.lost());
}

TEST(TrustInChain, EndsAForceThatShakesAndWaitsForTheUser) {
  const PlantProfile profile = omni(0.5, 1);
  ChainFixture rig(profile, profile, Hand::light());
  rig.device.reset({0.0, 0.0, -1.0}, Vec3::Zero());
  rig.device.setTarget({0.0, 0.0, -5.0});
  int lost = 0;
  for (int i = 0; i < 6000; ++i) {
    rig.dynamic_N = {i % 250 < 125 ? 1.6 : -1.6, 0.0, 0.0};
    lost += rig.step().trust_lost ? 1 : 0;
  }
  EXPECT_EQ(lost, 1) << "told once";
  EXPECT_EQ(rig.chain.halt(), Halt::kTrustLost);
  EXPECT_EQ(rig.out.force_N, Vec3::Zero());
  EXPECT_EQ(rig.max_excess_N, 0.0) << "it ramped down";
  rig.dynamic_N.setZero();
  rig.run(2000);
  EXPECT_EQ(rig.out.force_N, Vec3::Zero()) << "a stream that calms down is not trusted for it";
  rig.device.setTarget({0.0, 0.0, 10.0});
  rig.run(500);
  rig.chain.rearm();
  rig.device.setTarget({0.0, 0.0, -3.0});
  rig.run(1500);
  EXPECT_EQ(rig.chain.halt(), Halt::kNone);
  EXPECT_GT(rig.out.force_N.z(), 0.3);
}

TEST(TrustInChain, AStepOfTheStreamCountsOnceThoughTheForceCatchesUpForTicks) {
  const PlantProfile profile = omni(0.5, 1);
  ChainFixture rig(profile, profile, Hand::firm());
  rig.device.reset({0.0, 0.0, 5.0}, Vec3::Zero());
  rig.device.setTarget({0.0, 0.0, 5.0});
  rig.run(500);
  rig.device.setTarget({0.0, 0.0, -2.0});
  rig.run(2000);
  rig.clear();
  ASSERT_EQ(rig.chain.trustScore(), 0.0);
  rig.dynamic_N = {0.0, 0.0, 1.5};
  rig.run(20);
  EXPECT_GT(rig.count(SafetyAction::kSlew), 4U);
  EXPECT_NEAR(rig.chain.trustScore(), 1.0, 0.05);
}

TEST(Trust, AJumpEverySecondLosesItWithinAMinuteAndAClipOfTwoSecondsNever) {
  for (const int period : {1000, 1200, 2000, 4000}) {
    Trust trust;
    int lost_at = 0;
    for (int tick = 1; tick <= 600'000 && lost_at == 0; ++tick) {
      trust.add(0, tick % period == 0);
      if (trust.lost()) lost_at = tick;
    }
    EXPECT_EQ(lost_at > 0, period <= 1200) << period;
    if (period == 1000) {
      EXPECT_LT(lost_at, 60'000);
    }
  }
}

TEST(Trust, AVibrationAboveTheExposureLimitLosesIt) {
  for (const double weighted_m_s2 : {3.0, 10.0}) {
    Trust trust;
    bool lost = false;
    for (int tick = 0; tick < 120'000; ++tick) {
      // At 12 Hz the weighting is nearly 1.
      const double w_1_s = 2.0 * M_PI * 12.0;
      const double speed_mm_s =
          1e3 * weighted_m_s2 * M_SQRT2 / w_1_s * std::sin(w_1_s * tick * 1e-3);
      trust.add(0);
      trust.addMotion(speed_mm_s, speed_mm_s);
      lost = lost || trust.lost();
    }
    EXPECT_EQ(lost, weighted_m_s2 > 5.0) << weighted_m_s2;
  }
}

TEST(Trust, AHandThatShakesOnAStillSurfaceKeepsIt) {
  Trust trust;
  for (int tick = 0; tick < 120'000; ++tick) {
    trust.add(0);
    trust.addMotion(0.0, 500.0 * std::sin(0.06 * tick));
  }
  EXPECT_FALSE(trust.lost());
}

}  // namespace
}  // namespace hapticast::client
