// SPDX-License-Identifier: MIT
// Shared by the tests of re-arming: reports with a halt, a policy that has forgiven.
#pragma once

#include <gtest/gtest.h>

#include "client/haptics/rearm_policy.hpp"

namespace hapticast::client {

/// Returns a report of a moment with a halt.
inline TickReport makeHaltReport(double time_s, Halt halt, std::uint32_t safety_actions = 0) {
  TickReport report;
  report.time = localTime(time_s);
  report.halt = halt;
  report.safety_actions = safety_actions;
  report.trust_loss_cause = SafetyAction::kTank;
  report.lookup = Lookup::kInterpolated;
  return report;
}

/// Returns a policy that has forgiven so often.
inline RearmPolicy rearmAfter(int times) {
  RearmPolicy rearm(true);
  constexpr std::uint32_t kTank = bit(SafetyAction::kTank);
  for (int i = 0; i < times; ++i) {
    const double lost_s = 10.0 + 20.0 * i;
    EXPECT_EQ(rearm.left(), RearmPolicy::kMaxCount - i);
    EXPECT_FALSE(rearm.onReport(makeHaltReport(lost_s, Halt::kTrustLost, kTank)));
    EXPECT_FALSE(rearm.onReport(makeHaltReport(lost_s + 4.9, Halt::kTrustLost)));
    EXPECT_TRUE(rearm.onReport(makeHaltReport(lost_s + 5.1, Halt::kTrustLost)));
    EXPECT_FALSE(rearm.onReport(makeHaltReport(lost_s + 5.101, Halt::kTrustLost)))
        << "the loop is on its way";
    EXPECT_FALSE(rearm.onReport(makeHaltReport(lost_s + 5.102, Halt::kNone)));
  }
  return rearm;
}

}  // namespace hapticast::client
