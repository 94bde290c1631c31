// SPDX-License-Identifier: MIT
#include "common/sync/latest_value.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <thread>

namespace hapticast {
namespace {

TEST(LatestValue, StartsWithTheInitialValue) {
  LatestValue<int> latest(7);
  EXPECT_EQ(latest.load(), 7);
  EXPECT_EQ(latest.load(), 7);
}

TEST(LatestValue, GivesTheNewestAndKeepsIt) {
  LatestValue<int> latest(0);
  latest.store(1);
  latest.store(2);
  latest.store(3);
  EXPECT_EQ(latest.load(), 3);
  EXPECT_EQ(latest.load(), 3);
  latest.store(4);
  EXPECT_EQ(latest.load(), 4);
}

TEST(LatestValue, IsNeverTornAndNeverGoesBackBetweenTwoThreads) {
  using Value = std::array<std::uint64_t, 16>;
  LatestValue<Value> latest;
  constexpr std::uint64_t kCount = 200'000;
  std::thread writer([&] {
    Value value{};
    for (std::uint64_t i = 1; i <= kCount; ++i) {
      value.fill(i);
      latest.store(value);
    }
  });
  std::uint64_t last = 0, wrong = 0;
  while (last < kCount) {
    const Value& value = latest.load();
    for (const std::uint64_t each : value) wrong += each != value[0] ? 1 : 0;
    if (value[0] < last) ++wrong;
    last = value[0];
  }
  writer.join();
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace hapticast
