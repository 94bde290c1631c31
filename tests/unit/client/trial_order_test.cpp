// SPDX-License-Identifier: MIT
#include "client/study/trial_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

namespace hapticast::client {
namespace {

using Order = std::vector<std::size_t>;

/// Returns how often each condition has each place.
std::map<std::pair<std::size_t, std::size_t>, int> countPlaces(const std::vector<Order>& orders) {
  std::map<std::pair<std::size_t, std::size_t>, int> counts;
  for (const Order& order : orders)
    for (std::size_t place = 0; place < order.size(); ++place) ++counts[{place, order[place]}];
  return counts;
}

/// Returns how often each condition follows each other one.
std::map<std::pair<std::size_t, std::size_t>, int> countPairs(const std::vector<Order>& orders) {
  std::map<std::pair<std::size_t, std::size_t>, int> counts;
  for (const Order& order : orders)
    for (std::size_t place = 1; place < order.size(); ++place)
      ++counts[{order[place - 1], order[place]}];
  return counts;
}

template <class Counts>
void expectEqualCounts(const Counts& counts, std::size_t keys, int count) {
  EXPECT_EQ(counts.size(), keys);
  for (const auto& [key, times] : counts) EXPECT_EQ(times, count) << key.first << key.second;
}

TEST(TrialOrder, ALatinSquareHasEachConditionAtEachPlaceAndAfterEachOther) {
  for (std::size_t conditions = 2; conditions <= 9; ++conditions) {
    SCOPED_TRACE(conditions);
    const int squares = conditions % 2 == 0 ? 1 : 2;
    std::vector<Order> orders;
    for (std::uint64_t subject = 0; subject < conditions * static_cast<std::size_t>(squares);
         ++subject) {
      orders.push_back(makeTrialOrder({.order = TrialOrder::kLatinSquare,
                                       .conditions = conditions,
                                       .seed = 5,
                                       .subject = subject}));
    }
    expectEqualCounts(countPlaces(orders), conditions * conditions, squares);
    expectEqualCounts(countPairs(orders), conditions * (conditions - 1), squares);
  }
}

TEST(TrialOrder, ARandomOrderHasEachConditionOnceInABlock) {
  const TrialPlan plan{.conditions = 6, .blocks = 50, .seed = 1ULL << 40, .subject = 7};
  const Order order = makeTrialOrder(plan);
  ASSERT_EQ(order.size(), 300U);
  for (std::size_t block = 0; block < 50; ++block) {
    Order sorted(order.begin() + static_cast<std::ptrdiff_t>(6 * block),
                 order.begin() + static_cast<std::ptrdiff_t>(6 * block + 6));
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, (Order{0, 1, 2, 3, 4, 5}));
  }
  EXPECT_EQ(order, makeTrialOrder(plan));
}

TEST(TrialOrder, ASeedAndASubjectChangeARandomOrder) {
  const TrialPlan plan{.conditions = 8, .blocks = 4, .seed = 3, .subject = 1};
  TrialPlan other = plan;
  other.subject = 2;
  EXPECT_NE(makeTrialOrder(plan), makeTrialOrder(other));
  other = plan;
  other.seed = 3 + (1ULL << 32);
  EXPECT_NE(makeTrialOrder(plan), makeTrialOrder(other));
}

// The same order on every machine: the numbers are those of the first implementation.
TEST(TrialOrder, IsTheSameOnEveryMachine) {
  EXPECT_EQ(makeTrialOrder({.conditions = 8, .seed = 3, .subject = 1}),
            (Order{0, 2, 1, 5, 7, 3, 6, 4}));
}

TEST(TrialOrder, OneConditionAndNoBlockAreOrders) {
  EXPECT_EQ(makeTrialOrder({.order = TrialOrder::kLatinSquare, .blocks = 3}), (Order{0, 0, 0}));
  EXPECT_TRUE(makeTrialOrder({.conditions = 4, .blocks = 0}).empty());
}

}  // namespace
}  // namespace hapticast::client
