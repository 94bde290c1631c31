// SPDX-License-Identifier: MIT
#include "server/stream/refusal_schedule.hpp"

#include <gtest/gtest.h>

#include <random>

namespace hapticast::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(RefusalSchedule, ANetworkGetsOneAnswerASecond) {
  RefusalSchedule schedule;
  const LocalTime now = localTime(10.0);
  const LocalTime latest = now + seconds(2);
  EXPECT_EQ(schedule.reserve("a", now, latest), now);
  EXPECT_EQ(schedule.reserve("a", now, latest), now + seconds(1));
  EXPECT_EQ(schedule.reserve("b", now, latest), now) << "another network";
  EXPECT_EQ(schedule.reserve("a", now, latest), now + seconds(2));
  EXPECT_EQ(schedule.reserve("a", now, latest), std::nullopt);
  EXPECT_EQ(schedule.reserve("a", now, latest + seconds(1)), now + seconds(3))
      << "a refused reservation takes no time";
  EXPECT_EQ(schedule.reserve("a", now + seconds(9), now + seconds(9)), now + seconds(9));
}

/// Random guesses of a few networks: answers to one are a second apart, and a network that is alone
/// within its second does not wait.
TEST(RefusalSchedule, AnswersAreASecondApartAndNeverLate) {
  std::mt19937 random(6);
  RefusalSchedule schedule;
  std::map<std::string, LocalTime> last;
  LocalTime now = localTime(10.0);
  int waits = 0, none = 0;
  for (int round = 0; round < 20'000; ++round) {
    now += milliseconds(random() % 200);
    const std::string network(1, static_cast<char>('a' + random() % 5));
    const LocalTime latest = now + seconds(5);
    const auto time = schedule.reserve(network, now, latest);
    const auto before = last.find(network);
    const bool free = before == last.end() || now >= before->second + RefusalSchedule::kEvery;
    if (!time) {
      ASSERT_GT(before->second + RefusalSchedule::kEvery, latest);
      ++none;
      continue;
    }
    ASSERT_TRUE(*time >= now && *time <= latest);
    ASSERT_EQ(*time == now, free);
    ASSERT_TRUE(before == last.end() || *time - before->second >= RefusalSchedule::kEvery);
    last[network] = *time;
    waits += *time > now ? 1 : 0;
  }
  EXPECT_GT(waits, 1000);
  EXPECT_GT(none, 1000);
}

TEST(RefusalSchedule, ItsMemoryIsBounded) {
  RefusalSchedule schedule;
  const LocalTime now = localTime(10.0);
  constexpr auto kMany = static_cast<int>(RefusalSchedule::kMostNetworks);
  for (int i = 0; i < kMany; ++i) EXPECT_EQ(schedule.reserve(std::to_string(i), now, now), now);
  EXPECT_EQ(schedule.reserve("more", now, now), now);
  EXPECT_EQ(schedule.reserve("still more", now, now), std::nullopt) << "they share one time";
  EXPECT_EQ(schedule.size(), RefusalSchedule::kMostNetworks);
  const LocalTime later = now + seconds(1);
  EXPECT_EQ(schedule.reserve("still more", later, later), later);
  EXPECT_EQ(schedule.size(), 1U) << "the others are forgotten";
}

}  // namespace
}  // namespace hapticast::server
