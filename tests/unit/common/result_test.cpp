// SPDX-License-Identifier: MIT
#include "common/result.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace hapticast {
namespace {

TEST(Result, HoldsAValue) {
  Result<int> result = 5;
  ASSERT_TRUE(result.ok());
  result.value() = 6;
  EXPECT_EQ(result.value(), 6);
}

TEST(Result, HoldsAnError) {
  const Result<int> result = Error{"late"};
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().message, "late");
}

TEST(Result, HoldsAnErrorOfItsOwnKind) {
  const Result<int, std::pair<int, int>> result = std::pair(3, 4);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().second, 4);
}

TEST(Result, GivesItsValueAway) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(3);
  const std::unique_ptr<int> taken = std::move(result).value();
  EXPECT_EQ(*taken, 3);
}

}  // namespace
}  // namespace hapticast
