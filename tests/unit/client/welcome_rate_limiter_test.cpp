// SPDX-License-Identifier: MIT
#include "client/net/welcome_rate_limiter.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

TEST(WelcomeRateLimiterTest, AllowsThreeAtOnceAndThenOneASecond) {
  WelcomeRateLimiter limiter;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(limiter.allow(localTime(5.0))) << i;
  EXPECT_TRUE(limiter.allow(localTime(6.0)));
  EXPECT_FALSE(limiter.allow(localTime(6.9)));
}

TEST(WelcomeRateLimiterTest, AllowsOneASecondForever) {
  WelcomeRateLimiter limiter;
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(limiter.allow(localTime(1.0 + i))) << i;
}

}  // namespace
}  // namespace hapticast::client
