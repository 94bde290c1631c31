// SPDX-License-Identifier: MIT
#include "client/view/force_plot.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

TickReport tickOf(std::size_t tick, double force_N) {
  TickReport report;
  report.time = LocalTime(std::chrono::milliseconds(tick));
  report.force_N = {0.0, 0.0, force_N};
  report.contact = force_N > 0.0;
  return report;
}

TEST(ForceHistory, APointKeepsThePeakOfItsTicks) {
  ForceHistory history;
  for (std::size_t tick = 0; tick < 10; ++tick) history.add(tickOf(tick, tick == 7 ? 2.0 : 0.0));
  ASSERT_EQ(history.points().size(), 2U);
  EXPECT_EQ(history.points()[0].force_N, 0.0);
  EXPECT_FALSE(history.points()[0].contact);
  EXPECT_EQ(history.points()[1].time_s, 0.005);
  EXPECT_EQ(history.points()[1].force_N, 2.0);
  EXPECT_TRUE(history.points()[1].contact);
}

TEST(ForceHistory, OfAnHourKeepsTheLastMinute) {
  ForceHistory history;
  constexpr std::size_t kTicks = 3'600'000;
  for (std::size_t tick = 0; tick < kTicks; ++tick) history.add(tickOf(tick, 1.0));
  EXPECT_EQ(history.points().size(), ForceHistory::kMaxPoints);
  EXPECT_DOUBLE_EQ(history.points().front().time_s, 3600.0 - ForceHistory::kSeconds);
  EXPECT_DOUBLE_EQ(history.points().back().time_s, 3600.0 - 0.005);
}

}  // namespace
}  // namespace hapticast::client
