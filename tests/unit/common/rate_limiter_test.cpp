// SPDX-License-Identifier: MIT
#include "common/rate_limiter.hpp"

#include <gtest/gtest.h>

#include <deque>

namespace hapticast {
namespace {

TEST(RateLimiter, LetsSomeLinesThroughAndCountsTheRest) {
  RateLimiter limit;
  std::int64_t allowed = 0;
  for (int i = 0; i < 100; ++i) allowed += limit.allow(localTime(5.0)) ? 1 : 0;
  EXPECT_EQ(allowed, RateLimiter::kLogBurst);
  EXPECT_EQ(limit.popDropped(), 100U - RateLimiter::kLogBurst);
  EXPECT_EQ(limit.popDropped(), 0U);
  EXPECT_FALSE(limit.allow(localTime(19.9)));
  EXPECT_TRUE(limit.allow(localTime(20.0))) << "one line more every 15 s";
  EXPECT_FALSE(limit.allow(localTime(20.1)));
}

TEST(RateLimiter, NeverLetsMoreThanTenLinesThroughInAMinute) {
  RateLimiter limit;
  std::deque<double> lines_s;
  for (double now_s = 1000.0; now_s < 1600.0; now_s += 0.05) {
    const bool pause = now_s > 1200.0 && now_s < 1300.0;  // and what was saved up in it
    if (pause || !limit.allow(localTime(now_s))) continue;
    lines_s.push_back(now_s);
    while (now_s - lines_s.front() >= 60.0) lines_s.pop_front();
    ASSERT_LE(lines_s.size(), 10U) << now_s;
  }
  EXPECT_GE(lines_s.size(), 4U) << "a steady four a minute";
}

TEST(RateLimiter, AllowsItsBurstAtOnceAndThenItsRateForever) {
  RateLimiter limiter(3, std::chrono::seconds(1));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(limiter.allow(localTime(5.0))) << i;
  EXPECT_FALSE(limiter.allow(localTime(5.9)));
  for (int i = 6; i < 1000; ++i) EXPECT_TRUE(limiter.allow(localTime(i))) << i;
}

TEST(RateLimiter, OnceAMinuteBeginsWithTheEvent) {
  RateLimiter limiter = RateLimiter::makeOnceAMinute();
  EXPECT_TRUE(limiter.allow(localTime(59.0)));
  EXPECT_FALSE(limiter.allow(localTime(61.0)));
  EXPECT_TRUE(limiter.isReady(localTime(119.0)));
  EXPECT_TRUE(limiter.allow(localTime(119.0)));
}

}  // namespace
}  // namespace hapticast
