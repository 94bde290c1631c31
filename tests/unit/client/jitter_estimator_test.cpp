// SPDX-License-Identifier: MIT
#include "client/net/jitter_estimator.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

using std::chrono::milliseconds;
constexpr Duration kFrame = milliseconds(40);

/// Adds a frame that arrives at `at_s` and needs `needed`, of which one frame interval is the
/// look-ahead of the interpolation.
void addFrame(JitterEstimator& jitter, double at_s, Duration needed) {
  jitter.add({localTime(at_s), needed, localTime(at_s) - needed}, kFrame);
}

/// Adds `count` frames without jitter from `from_s` on. Returns the time of the next frame, s.
double addSteady(JitterEstimator& jitter, double from_s, int count) {
  for (int i = 0; i < count; ++i) addFrame(jitter, from_s + 0.04 * i, milliseconds(60));
  return from_s + 0.04 * count;
}

/// Adds an outage that begins at `from_s`: nothing arrives for `length_s`, then every frame of that
/// time at once. Returns the time of the next frame, s.
double addOutage(JitterEstimator& jitter, double from_s, double length_s) {
  const double end_s = from_s + length_s;
  for (double due_s = from_s; due_s <= end_s; due_s += 0.04)
    addFrame(jitter, end_s, kFrame + fromSeconds(end_s - due_s));
  return end_s + 0.04;
}

TEST(JitterEstimator, StartsWithTheLookaheadAndAMargin) {
  const JitterEstimator jitter;
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(45));
}

TEST(JitterEstimator, CoversAllFramesButOneInAHundred) {
  JitterEstimator jitter;
  for (int i = 1; i <= 100; ++i) addFrame(jitter, 0.04 * i, milliseconds(i));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(99 + 5));
}

TEST(JitterEstimator, OneLateFrameDecidesNothing) {
  JitterEstimator jitter;
  const double next_s = addSteady(jitter, 0.0, 20);
  addFrame(jitter, next_s + 0.2, milliseconds(240));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(65));
  addFrame(jitter, next_s + 0.24, milliseconds(200));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(205)) << "two of them are no accident";
}

TEST(JitterEstimator, OneOutageDecidesNothingHoweverManyFramesItDelayed) {
  for (const double length_s : {0.3, 0.8, 1.5, 3.0}) {
    JitterEstimator jitter;
    const double next_s = addOutage(jitter, addSteady(jitter, 0.0, 100), length_s);
    EXPECT_EQ(jitter.delay(kFrame), milliseconds(65)) << length_s;
    addSteady(jitter, next_s, 10);
    EXPECT_EQ(jitter.delay(kFrame), milliseconds(65)) << length_s;
  }
}

TEST(JitterEstimator, FramesThatWereDueBeforeTheConnectionDecideNothing) {
  JitterEstimator jitter;
  jitter.reset(localTime(5.0));
  for (int i = 0; i < 3; ++i) addFrame(jitter, 5.01, milliseconds(3000));
  addFrame(jitter, 5.02, milliseconds(1000));  // the first one in time, after a hole
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(45));
  addSteady(jitter, 5.06, 3);
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(65));
}

TEST(JitterEstimator, FramesThatAreAlwaysTooLateEndInTheLargestDelay) {
  JitterEstimator jitter;
  jitter.reset(localTime(0.0));
  for (int i = 0; i < 1000; ++i) {
    addFrame(jitter, 0.04 * i, milliseconds(8000));
    EXPECT_LE(jitter.delay(kFrame), JitterEstimator::kMaxDelay);
  }
  EXPECT_EQ(jitter.delay(kFrame), JitterEstimator::kMaxDelay);
}

TEST(JitterEstimator, ASecondOutageWithinTheWindowCounts) {
  JitterEstimator jitter;
  double next_s = addOutage(jitter, addSteady(jitter, 0.0, 100), 0.8);
  next_s = addOutage(jitter, addSteady(jitter, next_s, 10), 0.48);
  EXPECT_NEAR(toSeconds(jitter.delay(kFrame)), 0.48 + 0.04 + 0.005, 0.001)
      << "all outages but the longest";
  addSteady(jitter, next_s, 135);
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(65)) << "both have left the window";
}

TEST(JitterEstimator, ForgetsAfterItsWindow) {
  JitterEstimator jitter;
  for (int i = 0; i < 50; ++i) addFrame(jitter, 0.04 * i, milliseconds(300));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(305));
  for (int i = 0; i < 130; ++i) addFrame(jitter, 2.0 + 0.04 * i, milliseconds(50));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(55));
}

TEST(JitterEstimator, FollowsAClockThatTurnsOutToBeOff) {
  JitterEstimator jitter;
  addSteady(jitter, 0.0, 50);
  jitter.shift(milliseconds(30));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(95));
  jitter.shift(Duration::min());
  EXPECT_EQ(jitter.delay(kFrame), kFrame);
}

TEST(JitterEstimator, StaysWithinItsBounds) {
  JitterEstimator jitter;
  jitter.add({localTime(0), Duration::max(), localTime(0)}, kFrame);
  EXPECT_EQ(jitter.delay(kFrame), JitterEstimator::kMaxDelay);
  jitter.reset(localTime(-10));
  jitter.add({localTime(0), Duration::min(), localTime(0)}, kFrame);
  EXPECT_EQ(jitter.delay(kFrame), kFrame) << "never less than the interpolation looks ahead";
  EXPECT_EQ(jitter.delay(std::chrono::seconds(3)), JitterEstimator::kMaxDelay);
}

TEST(JitterEstimator, NeverExceedsTheLargestDelayOfTheUser) {
  JitterEstimator jitter(milliseconds(300));
  for (int i = 0; i < 50; ++i) addFrame(jitter, 0.04 * i, milliseconds(700));
  EXPECT_EQ(jitter.delay(kFrame), milliseconds(300));
}

}  // namespace
}  // namespace hapticast::client
