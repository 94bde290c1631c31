// SPDX-License-Identifier: MIT
#include "client/haptics/safety/safety_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace hapticast::client {
namespace {

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

TEST(SafetyStates, AStreamThatMovesTheHandIsLatchedUntilTheUserRearms) {
  for (const double power_W : {0.009, 0.011}) {
    SafetyStates states;
    std::uint32_t bits = 0;
    for (int tick = 0; tick < 60'000; ++tick) {  // 30 s of work, 30 s without
      bits = states.update(localTime(tick * 1e-3), power_W * std::min(tick, 30'000), Halt::kNone,
                           false);
      if (power_W > 0.01 && tick > 10'100) {
        ASSERT_EQ(bits, bit(SafetyState::kMovesHand)) << tick;
      }
    }
    if (power_W < 0.01) {
      EXPECT_EQ(bits, 0U);
    }
    EXPECT_EQ(states.update(localTime(61.0), power_W * 30'000, Halt::kNone, true) &
                  bit(SafetyState::kMovesHand),
              0U);
  }
}

TEST(SafetyStates, ALossOfTrustIsLatchedUntilTheUserRearms) {
  SafetyStates states;
  EXPECT_EQ(states.update(localTime(1.0), 0.0, Halt::kTrustLost, false),
            bit(SafetyState::kTrustLost) | bit(SafetyState::kForceOff));
  for (int tick = 0; tick < 20'000; ++tick)
    (void)states.update(localTime(1.001 + tick * 1e-3), 0.0, Halt::kNone, false);
  EXPECT_EQ(states.update(localTime(21.002), 0.0, Halt::kNone, false),
            bit(SafetyState::kTrustLost));
  EXPECT_EQ(states.update(localTime(21.003), 0.0, Halt::kNone, true), 0U);
}

TEST(SafetyStates, TheEndOfTheClientIsNoState) {
  SafetyStates states;
  EXPECT_EQ(states.update(localTime(1.0), 0.0, Halt::kStopped, false), 0U);
}

TEST(SafetyStates, AMachineIsLateAsLongAsItIsAndAMinuteMore) {
  SafetyStates states;
  double now_s = 1.0;
  std::uint32_t bits = 0;
  const auto tick = [&](double step_s) {
    now_s += step_s;
    bits = states.update(localTime(now_s), 0.0, Halt::kNone, false);
  };
  for (int i = 0; i < 5000; ++i) tick(i % 500 == 0 ? 2e-3 : 1e-3);  // two a second
  EXPECT_EQ(bits, 0U);
  for (int i = 0; i < 1000; ++i) tick(i % 50 == 0 ? 2e-3 : 1e-3);  // 20 a second
  EXPECT_EQ(bits, bit(SafetyState::kLateMachine));
  for (int i = 0; i < 59'000; ++i) tick(1e-3);
  EXPECT_EQ(bits, bit(SafetyState::kLateMachine));
  for (int i = 0; i < 4000; ++i) tick(1e-3);
  EXPECT_EQ(bits, 0U);
  tick(25e-3);
  EXPECT_EQ(bits, bit(SafetyState::kLateMachine)) << "one gap that restarts the estimate";
}

}  // namespace
}  // namespace hapticast::client
