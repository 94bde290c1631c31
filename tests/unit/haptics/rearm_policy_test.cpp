// SPDX-License-Identifier: MIT
#include "client/haptics/rearm_policy.hpp"

#include <gtest/gtest.h>

#include "tests/unit/haptics/rearm_fixture.hpp"

namespace hapticast::client {
namespace {

TEST(RearmPolicy, ForgivesThreeTimesFiveSecondsLater) {
  RearmPolicy rearm = rearmAfter(3);
  EXPECT_EQ(rearm.left(), 0);
  EXPECT_FALSE(rearm.onReport(makeHaltReport(100.0, Halt::kTrustLost)));
  EXPECT_FALSE(rearm.onReport(makeHaltReport(200.0, Halt::kTrustLost)));
}

TEST(RearmPolicy, BringsADeviceBackAsOftenAsItComes) {
  RearmPolicy rearm(true);
  for (int i = 0; i < 10; ++i) {
    TickReport lost = makeHaltReport(i, Halt::kDeviceLost);
    lost.device = DeviceStatus::kLost;
    EXPECT_FALSE(rearm.onReport(lost));
    EXPECT_TRUE(rearm.onReport(makeHaltReport(i + 0.5, Halt::kDeviceLost)));
    EXPECT_FALSE(rearm.onReport(makeHaltReport(i + 0.6, Halt::kNone)));
  }
}

TEST(RearmPolicy, BringsADeviceBackThatIsLostAgainBeforeTheLoopAnswers) {
  RearmPolicy rearm(true);
  TickReport lost = makeHaltReport(1.0, Halt::kDeviceLost);
  lost.device = DeviceStatus::kLost;
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(rearm.onReport(lost));
    EXPECT_TRUE(rearm.onReport(makeHaltReport(2.0, Halt::kDeviceLost)));
    EXPECT_FALSE(rearm.onReport(makeHaltReport(2.1, Halt::kDeviceLost)));
  }
}

TEST(RearmPolicy, WithoutTheFlagNothingComesBack) {
  RearmPolicy rearm(false);
  EXPECT_EQ(rearm.left(), 0);
  EXPECT_FALSE(rearm.onReport(makeHaltReport(1.0, Halt::kDeviceLost)));
  EXPECT_FALSE(rearm.onReport(makeHaltReport(100.0, Halt::kTrustLost)));
  EXPECT_FALSE(rearm.onReport(makeHaltReport(200.0, Halt::kStopped)));
}

}  // namespace
}  // namespace hapticast::client
