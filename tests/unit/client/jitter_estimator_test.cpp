// SPDX-License-Identifier: MIT
#include "client/net/jitter_estimator.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

using std::chrono::milliseconds;
constexpr Duration kFrame = milliseconds(40);

TEST(JitterEstimator, StartsWithTheLookaheadAndAMargin) {
  const JitterEstimator jitter;
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(45));
}

TEST(JitterEstimator, CoversAllFramesButOneInAHundred) {
  JitterEstimator jitter;
  for (int i = 1; i <= 100; ++i) jitter.add(localTime(0.04 * i), milliseconds(i));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(99 + 5));
}

TEST(JitterEstimator, OneLateFrameAfterAnOutageDecidesNothing) {
  JitterEstimator jitter;
  for (int i = 1; i <= 20; ++i) jitter.add(localTime(0.04 * i), milliseconds(60));
  jitter.add(localTime(1.8), milliseconds(1000));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(65));
  jitter.add(localTime(2.0), milliseconds(300));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(305)) << "two of them are no accident";
}

TEST(JitterEstimator, ForgetsAfterItsWindow) {
  JitterEstimator jitter;
  for (int i = 0; i < 50; ++i) jitter.add(localTime(0.04 * i), milliseconds(300));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(305));
  for (int i = 0; i < 130; ++i) jitter.add(localTime(2.0 + 0.04 * i), milliseconds(50));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(55));
}

TEST(JitterEstimator, FollowsAClockThatTurnsOutToBeOff) {
  JitterEstimator jitter;
  for (int i = 0; i < 50; ++i) jitter.add(localTime(0.04 * i), milliseconds(60));
  jitter.shift(milliseconds(30));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(95));
  jitter.shift(Duration::min());
  EXPECT_EQ(jitter.delay(kFrame), kFrame);
}

TEST(JitterEstimator, StaysWithinItsBounds) {
  JitterEstimator jitter;
  jitter.add(localTime(0), Duration::max());
  EXPECT_EQ(jitter.delay(kFrame), JitterEstimator::kMaxDelay);
  jitter.reset();
  jitter.add(localTime(0), Duration::min());
  EXPECT_EQ(jitter.delay(kFrame), kFrame) << "never less than the interpolation looks ahead";
  EXPECT_EQ(jitter.delay(std::chrono::seconds(3)), JitterEstimator::kMaxDelay);
}

}  // namespace
}  // namespace hapticast::client
