// SPDX-License-Identifier: MIT
#include "common/sync/spsc_ring.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace hapticast {
namespace {

TEST(SpscRing, HoldsItsCapacityInOrder) {
  SpscRing<int, 4> ring;
  int value = 0;
  EXPECT_FALSE(ring.tryPop(value));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.tryPush(i));
  EXPECT_FALSE(ring.tryPush(4)) << "full";
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.tryPop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.tryPop(value));
}

TEST(SpscRing, WrapsAround) {
  SpscRing<int, 2> ring;
  int value = 0;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(ring.tryPush(i));
    ASSERT_TRUE(ring.tryPop(value));
    ASSERT_EQ(value, i);
  }
}

TEST(SpscRing, CarriesEverythingBetweenTwoThreads) {
  struct Pair {
    std::uint64_t a = 0, b = 0;
  };
  constexpr std::uint64_t kCount = 200'000;
  SpscRing<Pair, 64> ring;
  std::thread producer([&] {
    for (std::uint64_t i = 0; i < kCount; ++i) {
      while (!ring.tryPush({i, ~i})) std::this_thread::yield();
    }
  });
  std::uint64_t torn = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    Pair pair;
    while (!ring.tryPop(pair)) std::this_thread::yield();
    if (pair.a != i || pair.b != ~i) ++torn;
  }
  producer.join();
  EXPECT_EQ(torn, 0U);
}

}  // namespace
}  // namespace hapticast
