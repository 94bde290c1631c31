// SPDX-License-Identifier: MIT
// The lines about why there is no force, and how often they come.
#include <gtest/gtest.h>

#include "client/report/messages.hpp"
#include "tests/unit/haptics/rearm_fixture.hpp"

namespace hapticast::client {
namespace {

const RearmPolicy kNever(false);

/// Returns the lines of a report, one after the other.
std::string joinLines(HapticStatusLog& log, const TickReport& report, const RearmPolicy& rearm) {
  std::string all;
  for (const std::string& line : log.onReport(report, rearm)) all += line;
  return all;
}

TEST(HapticStatusLog, ReportsWhyThereIsNoForceAndThatItIsBack) {
  HapticStatusLog log;
  EXPECT_EQ(joinLines(log, makeHaltReport(1.0, Halt::kNone), kNever), "");
  EXPECT_EQ(joinLines(log, makeHaltReport(2.0, Halt::kTrustLost), kNever),
            "the client does not trust the stream any more, because the safety chain acted too "
            "often (mostly: the energy into the hand was limited): no force from now on; restart "
            "the client to touch this stream (--rearm restores the force automatically)");
  EXPECT_EQ(joinLines(log, makeHaltReport(3.0, Halt::kTrustLost), kNever), "");
  EXPECT_EQ(joinLines(log, makeHaltReport(4.0, Halt::kNone), kNever),
            "re-armed: the force returns");
  EXPECT_EQ(joinLines(log, makeHaltReport(5.0, Halt::kTrustLost), rearmAfter(2)),
            "the client does not trust the stream any more, because the safety chain acted too "
            "often (mostly: the energy into the hand was limited): no force for 5 s; the client "
            "re-arms it automatically 1 more time");
  EXPECT_TRUE(joinLines(log, makeHaltReport(6.0, Halt::kDeviceLost), kNever)
                  .starts_with("the device does not answer"));
  EXPECT_EQ(joinLines(log, makeHaltReport(7.0, Halt::kStopped), kNever), "")
      << "the end is no news";
}

TEST(HapticStatusLog, ReportsThatFramesStayOutAndComeAgain) {
  HapticStatusLog log;
  TickReport report = makeHaltReport(1.0, Halt::kNone);
  EXPECT_EQ(joinLines(log, report, kNever), "");
  report.lookup = Lookup::kHeld;
  EXPECT_EQ(joinLines(log, report, kNever), "");
  report.lookup = Lookup::kStale;
  EXPECT_EQ(joinLines(log, report, kNever), "no new frames arrive: the force has faded");
  EXPECT_EQ(joinLines(log, report, kNever), "");
  report.lookup = Lookup::kInterpolated;
  EXPECT_EQ(joinLines(log, report, kNever), "frames arrive again");
}

TEST(HapticStatusLog, ReportsOnceThatNoFrameHasEverArrived) {
  HapticStatusLog log;
  const auto line = [&](double time_s, Lookup lookup = Lookup::kEmpty) {
    TickReport report = makeHaltReport(time_s, Halt::kNone);
    report.lookup = lookup;
    return joinLines(log, report, kNever);
  };
  EXPECT_EQ(line(-9.0), "");
  EXPECT_EQ(line(-1.0, Lookup::kInterpolated), "");
  EXPECT_EQ(line(1.0), "") << "another server took over";
  EXPECT_EQ(line(3.9), "");
  EXPECT_EQ(line(4.1), "no frames arrive: there is nothing to touch yet");
  EXPECT_EQ(line(9.0), "");
}

TEST(HapticStatusLog, ReportsThatADeviceComesBackThoughNoTrustIsLeftToForgive) {
  HapticStatusLog log;
  EXPECT_EQ(joinLines(log, makeHaltReport(1.0, Halt::kDeviceLost), rearmAfter(3)),
            "the device does not answer: no force until it answers again");
  EXPECT_TRUE(joinLines(log, makeHaltReport(2.0, Halt::kTrustLost), rearmAfter(3))
                  .ends_with("no force from now on; restart the client to touch this stream"));
}

TEST(HapticStatusLog, ReportsAHaltEvenIfOtherLinesUsedUpTheLimit) {
  HapticStatusLog log;
  for (int i = 0; i < 100; ++i) {
    TickReport report = makeHaltReport(1.0 + i * 0.1, Halt::kNone);
    report.lookup = i % 2 == 0 ? Lookup::kStale : Lookup::kInterpolated;
    EXPECT_EQ(!joinLines(log, report, kNever).empty(), i < RateLimiter::kLogBurst);
  }
  EXPECT_NE(joinLines(log, makeHaltReport(20.0, Halt::kTrustLost), kNever), "");
}

TEST(HapticStatusLog, ReportsADeviceWithALoosePlugOnce) {
  HapticStatusLog log;
  std::string lines;
  for (int i = 0; i < 59'000; ++i) {
    TickReport report =
        makeHaltReport(1.0 + i * 1e-3, i % 700 < 300 ? Halt::kDeviceLost : Halt::kNone);
    report.safety_states = bit(SafetyState::kForceOff);
    lines += joinLines(log, report, kNever);
  }
  EXPECT_EQ(lines,
            "the device does not answer: no force from now on (--rearm restores the force "
            "automatically)re-armed: the force returns");
}

TEST(HapticStatusLog, ReportsASafetyStateEvenIfOtherLinesUsedUpTheLimit) {
  HapticStatusLog log;
  for (int i = 0; i < 100; ++i) {
    TickReport report = makeHaltReport(1.0 + i * 0.1, Halt::kNone);
    report.lookup = i % 2 == 0 ? Lookup::kStale : Lookup::kInterpolated;
    (void)joinLines(log, report, kNever);
  }
  TickReport report = makeHaltReport(20.0, Halt::kNone);
  report.safety_states = bit(SafetyState::kMovesHand);
  EXPECT_EQ(joinLines(log, report, kNever), toText(SafetyState::kMovesHand));
  report.safety_states |= bit(SafetyState::kLateMachine);
  EXPECT_EQ(joinLines(log, report, kNever), toText(SafetyState::kLateMachine));
  EXPECT_EQ(joinLines(log, report, kNever), "");
}

TEST(HapticStatusLog, ReportsOnceAMinuteThatAWallIsSofter) {
  HapticStatusLog log;
  int lines = 0;
  for (int i = 0; i < 150; ++i) {
    lines += joinLines(log, makeHaltReport(i, Halt::kNone, bit(SafetyAction::kStiffness)), kNever)
                     .empty()
                 ? 0
                 : 1;
  }
  EXPECT_EQ(lines, 3);
}

TEST(HapticStatusLog, NamesTheKeyOfTheWindow) {
  const auto describe = [](Halt halt, const RearmPolicy& rearm) {
    HapticStatusLog log;
    TickReport report;
    report.halt = halt;
    return joinLines(log, report, rearm);
  };
  EXPECT_TRUE(describe(Halt::kTrustLost, RearmPolicy(false, true))
                  .ends_with("no force until you press R in the window"));
  EXPECT_NE(describe(Halt::kTrustLost, RearmPolicy(false)).find("--rearm"), std::string::npos);
  EXPECT_EQ(
      describe(Halt::kDeviceLost, RearmPolicy(false, true)),
      "the device does not answer: no force until it answers again and you press R in the window");
  EXPECT_EQ(describe(Halt::kDeviceLost, RearmPolicy(true, true)),
            "the device does not answer: no force until it answers again");
}

}  // namespace
}  // namespace hapticast::client
