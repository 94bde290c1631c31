// SPDX-License-Identifier: MIT
// Election of the active origin without a network.
#include "server/relay/origin_election.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace hapticast::server {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kTerm = 1000;

LocalTime timeAt(Duration time) { return LocalTime(10s) + time; }

TEST(OriginElection, TakesOverAfterASecondOfSilenceWithAHigherTerm) {
  OriginElection election(7, kTerm, timeAt(0s));
  EXPECT_FALSE(election.check(timeAt(999ms)));
  EXPECT_TRUE(election.check(timeAt(1s)));
  EXPECT_EQ(election.term(), kTerm + 1);
}

TEST(OriginElection, StaysStandbyWhileAnotherSends) {
  OriginElection election(7, kTerm, timeAt(0s));
  for (auto time = 0ms; time < 5s; time += 100ms) {
    election.onHeartbeat(kTerm + 5, 9, timeAt(time));
    EXPECT_FALSE(election.check(timeAt(time + 99ms)));
  }
  election.onDisconnected(timeAt(4950ms));
  EXPECT_EQ(election.heardAt(), timeAt(4900ms));
  EXPECT_TRUE(election.check(timeAt(6s)));
  EXPECT_EQ(election.term(), kTerm + 6);
}

TEST(OriginElection, StaysStandbyForAnOriginThatStartedEarlier) {
  OriginElection election(7, kTerm, timeAt(0s));
  for (auto time = 0ms; time < 5s; time += 100ms) {
    election.onHeartbeat(kTerm - 60, 9, timeAt(time));
    EXPECT_FALSE(election.check(timeAt(time + 99ms)));
  }
  EXPECT_TRUE(election.check(timeAt(6s)));
  EXPECT_EQ(election.term(), kTerm + 1) << "above its own start, too";
}

TEST(OriginElection, StepsBackForAHigherTermAndForAHigherOriginOfTheSameTerm) {
  OriginElection election(7, kTerm, timeAt(0s));
  ASSERT_TRUE(election.check(timeAt(1s)));
  election.onHeartbeat(kTerm, 99, timeAt(1100ms));
  EXPECT_TRUE(election.active()) << "a lower term";
  election.onHeartbeat(kTerm + 1, 6, timeAt(1200ms));
  EXPECT_TRUE(election.active()) << "the same term, a lower origin";
  election.onHeartbeat(kTerm + 1, 8, timeAt(1300ms));
  EXPECT_FALSE(election.active());
}

TEST(OriginElection, SendsUntilItReceivesTheOriginWhoseTermEdgesHaveProved) {
  OriginElection election(7, kTerm, timeAt(0s));
  ASSERT_TRUE(election.check(timeAt(1s)));
  election.onProvedTerm(kTerm + 50, timeAt(2s));
  EXPECT_TRUE(election.check(timeAt(2900ms)));
  EXPECT_EQ(election.term(), kTerm + 1);
  election.onHeartbeat(kTerm + 50, 9, timeAt(2950ms));
  EXPECT_FALSE(election.check(timeAt(3s)));
}

TEST(OriginElection, TakesOverFromAnOriginThatOnlyEdgesHaveSeen) {
  OriginElection election(7, kTerm, timeAt(0s));
  ASSERT_TRUE(election.check(timeAt(1s)));
  election.onProvedTerm(kTerm + 1, timeAt(1s));
  EXPECT_TRUE(election.check(timeAt(5s)));
  EXPECT_EQ(election.term(), kTerm + 1) << "its own term";
  election.onProvedTerm(kTerm + 50, timeAt(6s));
  election.onProvedTerm(kTerm + 50, timeAt(6900ms));
  EXPECT_TRUE(election.check(timeAt(7s)));
  EXPECT_EQ(election.term(), kTerm + 51);
}

TEST(OriginElection, DoesNotCountTheTimeWithoutAConnection) {
  OriginElection election(7, kTerm, timeAt(0s));
  for (auto time = 0ms; time <= 5s; time += 100ms) {
    election.onDisconnected(timeAt(time));
    EXPECT_FALSE(election.check(timeAt(time)));
  }
  EXPECT_FALSE(election.check(timeAt(5900ms)));
  EXPECT_TRUE(election.check(timeAt(6s)));
}

// However heartbeats of several origins are delayed and lost, at most one origin remains active
// once they arrive again.
TEST(OriginElection, OneOriginRemainsAfterEveryPartition) {
  std::mt19937 random(33);
  for (int round = 0; round < 200; ++round) {
    std::vector<OriginElection> origins;
    for (std::uint64_t i = 0; i < 3; ++i)
      origins.emplace_back(random() % 1000 + 1000 * i, kTerm, timeAt(0s));
    const Duration healed = std::chrono::milliseconds(random() % 8000);
    for (Duration time{}; time < healed + 3s; time += 100ms) {
      for (std::size_t from = 0; from < origins.size(); ++from) {
        if (!origins[from].check(timeAt(time))) continue;
        for (std::size_t to = 0; to < origins.size(); ++to) {
          const bool lost = time < healed && random() % 3 != 0;
          if (to != from && !lost)
            origins[to].onHeartbeat(origins[from].term(), origins[from].origin(), timeAt(time));
        }
      }
    }
    const auto active = std::count_if(origins.begin(), origins.end(),
                                      [](const OriginElection& each) { return each.active(); });
    EXPECT_EQ(active, 1) << "round " << round;
  }
}

}  // namespace
}  // namespace hapticast::server
