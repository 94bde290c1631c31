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

TEST(WorkMeter, GivesTheWorkOfTheLastTenSeconds) {
  WorkMeter meter;
  double done_mJ = 0.0;
  for (int tick = 0; tick < 20000; ++tick) {  // 20 mW for 15 s, then none
    done_mJ = meter.onWork(0.02 * std::min(tick, 15000), localTime(tick * 1e-3));
    if (tick == 4000) {
      EXPECT_NEAR(done_mJ, 80.0, 2.0);
    } else if (tick == 14000) {
      EXPECT_NEAR(done_mJ, 200.0, 2.0);
    }
  }
  EXPECT_NEAR(done_mJ, 100.0, 2.0);
}

TEST(HapticStatusLog, ReportsAStreamThatMovesTheHand) {
  for (const double power_W : {0.009, 0.011}) {
    HapticStatusLog log;
    const RearmPolicy rearm(false, false);
    int lines = 0;
    TickReport report;
    report.lookup = Lookup::kInterpolated;
    for (int tick = 0; tick < 30000; ++tick) {
      report.time = localTime(tick * 1e-3);
      report.work.surface_mJ = power_W * tick;
      const auto line = log.onReport(report, rearm);
      lines += line && line->find("the stream moves the hand") != std::string::npos;
    }
    EXPECT_EQ(lines, power_W > 0.01 ? 1 : 0) << power_W;
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

TEST(SafetyTrust, EndsAForceThatShakesAndWaitsForTheUser) {
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

TEST(SafetyTrust, AStepOfTheStreamCountsOnceThoughTheForceCatchesUpForTicks) {
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

/// A report at a time.
TickReport at(double time_s, Halt halt, std::uint32_t safety_actions = 0) {
  TickReport report;
  report.time = localTime(time_s);
  report.halt = halt;
  report.safety_actions = safety_actions;
  report.trust_loss_cause = SafetyAction::kTank;
  report.lookup = Lookup::kInterpolated;
  return report;
}

/// One that has forgiven so often.
RearmPolicy rearmAfter(int times) {
  RearmPolicy rearm(true);
  for (int i = 0; i < times; ++i) {
    const double lost_s = 10.0 + 20.0 * i;
    EXPECT_EQ(rearm.left(), RearmPolicy::kMaxCount - i);
    EXPECT_FALSE(rearm.onReport(at(lost_s, Halt::kTrustLost, kTankBit)));
    EXPECT_FALSE(rearm.onReport(at(lost_s + 4.9, Halt::kTrustLost)));
    EXPECT_TRUE(rearm.onReport(at(lost_s + 5.1, Halt::kTrustLost)));
    EXPECT_FALSE(rearm.onReport(at(lost_s + 5.101, Halt::kTrustLost))) << "the loop is on its way";
    EXPECT_FALSE(rearm.onReport(at(lost_s + 5.102, Halt::kNone)));
  }
  return rearm;
}

TEST(RearmPolicy, ForgivesThreeTimesFiveSecondsLater) {
  RearmPolicy rearm = rearmAfter(3);
  EXPECT_EQ(rearm.left(), 0);
  EXPECT_FALSE(rearm.onReport(at(100.0, Halt::kTrustLost)));
  EXPECT_FALSE(rearm.onReport(at(200.0, Halt::kTrustLost)));
}

TEST(RearmPolicy, BringsADeviceBackAsOftenAsItComes) {
  RearmPolicy rearm(true);
  for (int i = 0; i < 10; ++i) {
    TickReport lost = at(i, Halt::kDeviceLost);
    lost.device = DeviceStatus::kLost;
    EXPECT_FALSE(rearm.onReport(lost));
    EXPECT_TRUE(rearm.onReport(at(i + 0.5, Halt::kDeviceLost)));
    EXPECT_FALSE(rearm.onReport(at(i + 0.6, Halt::kNone)));
  }
}

TEST(RearmPolicy, BringsADeviceBackThatIsLostAgainBeforeTheLoopAnswers) {
  RearmPolicy rearm(true);
  TickReport lost = at(1.0, Halt::kDeviceLost);
  lost.device = DeviceStatus::kLost;
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(rearm.onReport(lost));
    EXPECT_TRUE(rearm.onReport(at(2.0, Halt::kDeviceLost)));
    EXPECT_FALSE(rearm.onReport(at(2.1, Halt::kDeviceLost)));
  }
}

TEST(RearmPolicy, WithoutTheFlagNothingComesBack) {
  RearmPolicy rearm(false);
  EXPECT_EQ(rearm.left(), 0);
  EXPECT_FALSE(rearm.onReport(at(1.0, Halt::kDeviceLost)));
  EXPECT_FALSE(rearm.onReport(at(100.0, Halt::kTrustLost)));
  EXPECT_FALSE(rearm.onReport(at(200.0, Halt::kStopped)));
}

const RearmPolicy kNever(false);

TEST(HapticStatusLog, ReportsWhyThereIsNoForceAndThatItIsBack) {
  HapticStatusLog log;
  EXPECT_FALSE(log.onReport(at(1.0, Halt::kNone), kNever));
  EXPECT_EQ(log.onReport(at(2.0, Halt::kTrustLost), kNever),
            "the client does not trust the stream any more, because the safety chain acted too "
            "often (mostly: the energy into the hand was limited): no force from now on; restart "
            "the client to touch this stream (--rearm restores the force automatically)");
  EXPECT_FALSE(log.onReport(at(3.0, Halt::kTrustLost), kNever));
  EXPECT_EQ(log.onReport(at(4.0, Halt::kNone), kNever), "re-armed: the force returns");
  EXPECT_EQ(log.onReport(at(5.0, Halt::kTrustLost), rearmAfter(2)),
            "the client does not trust the stream any more, because the safety chain acted too "
            "often (mostly: the energy into the hand was limited): no force for 5 s; the client "
            "re-arms it automatically 1 more time");
  EXPECT_TRUE(
      log.onReport(at(6.0, Halt::kDeviceLost), kNever)->starts_with("the device does not answer"));
  EXPECT_FALSE(log.onReport(at(7.0, Halt::kStopped), kNever)) << "the end is no news";
}

TEST(HapticStatusLog, ReportsThatFramesStayOutAndComeAgain) {
  HapticStatusLog log;
  TickReport report = at(1.0, Halt::kNone);
  EXPECT_FALSE(log.onReport(report, kNever));
  report.lookup = Lookup::kHeld;
  EXPECT_FALSE(log.onReport(report, kNever));
  report.lookup = Lookup::kStale;
  EXPECT_EQ(log.onReport(report, kNever), "no new frames arrive: the force has faded");
  EXPECT_FALSE(log.onReport(report, kNever));
  report.lookup = Lookup::kInterpolated;
  EXPECT_EQ(log.onReport(report, kNever), "frames arrive again");
}

TEST(HapticStatusLog, ReportsOnceThatNoFrameHasEverArrived) {
  HapticStatusLog log;
  const auto line = [&](double time_s, Lookup lookup = Lookup::kEmpty) {
    TickReport report = at(time_s, Halt::kNone);
    report.lookup = lookup;
    return log.onReport(report, kNever);
  };
  EXPECT_FALSE(line(-9.0));
  EXPECT_FALSE(line(-1.0, Lookup::kInterpolated));
  EXPECT_FALSE(line(1.0)) << "another server took over";
  EXPECT_FALSE(line(3.9));
  EXPECT_EQ(line(4.1), "no frames arrive: there is nothing to touch yet");
  EXPECT_FALSE(line(9.0));
}

TEST(HapticStatusLog, ReportsThatADeviceComesBackThoughNoTrustIsLeftToForgive) {
  HapticStatusLog log;
  EXPECT_EQ(log.onReport(at(1.0, Halt::kDeviceLost), rearmAfter(3)),
            "the device does not answer: no force until it answers again");
  EXPECT_TRUE(log.onReport(at(2.0, Halt::kTrustLost), rearmAfter(3))
                  ->ends_with("no force from now on; restart the client to touch this stream"));
}

TEST(HapticStatusLog, ReportsAHaltEvenIfOtherLinesUsedUpTheLimit) {
  HapticStatusLog log;
  for (int i = 0; i < 100; ++i) {
    TickReport report = at(1.0 + i * 0.1, Halt::kNone);
    report.lookup = i % 2 == 0 ? Lookup::kStale : Lookup::kInterpolated;
    EXPECT_EQ(log.onReport(report, kNever).has_value(), i < RateLimiter::kLogBurst);
  }
  EXPECT_TRUE(log.onReport(at(20.0, Halt::kTrustLost), kNever));
}

TEST(HapticStatusLog, ReportsAtMostTenHaltsAndTenOtherLinesAMinute) {
  HapticStatusLog log;
  int lines = 0;
  for (int i = 0; i < 59'000; ++i) {
    TickReport report = at(1.0 + i * 1e-3, i % 7 < 3 ? Halt::kTrustLost : Halt::kNone,
                           bit(SafetyAction::kStiffness));
    report.lookup = i % 2 == 0 ? Lookup::kStale : Lookup::kInterpolated;
    lines += log.onReport(report, kNever) ? 1 : 0;
  }
  EXPECT_EQ(lines, 2 * (RateLimiter::kLogBurst + 3)) << "a token comes back at 15, 30 and 45 s";
}

TEST(HapticStatusLog, ReportsOnceAMinuteThatAWallIsSofter) {
  HapticStatusLog log;
  int lines = 0;
  for (int i = 0; i < 150; ++i) {
    lines += log.onReport(at(i, Halt::kNone, bit(SafetyAction::kStiffness)), kNever) ? 1 : 0;
  }
  EXPECT_EQ(lines, 3);
}

TEST(Trust, WhereThereIsAWindowItsKeyIsNamed) {
  TickReport report;
  report.halt = Halt::kTrustLost;
  EXPECT_NE(HapticStatusLog()
                .onReport(report, RearmPolicy(false, true))
                .value_or("")
                .find("no force until you press R in the window"),
            std::string::npos);
  EXPECT_NE(HapticStatusLog().onReport(report, RearmPolicy(false)).value_or("").find("--rearm"),
            std::string::npos);
  report.halt = Halt::kDeviceLost;
  EXPECT_EQ(
      HapticStatusLog().onReport(report, RearmPolicy(false, true)),
      "the device does not answer: no force until it answers again and you press R in the window");
  EXPECT_EQ(HapticStatusLog().onReport(report, RearmPolicy(true, true)),
            "the device does not answer: no force until it answers again");
}

}  // namespace
}  // namespace hapticast::client
