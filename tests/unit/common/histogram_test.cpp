// SPDX-License-Identifier: MIT
#include "common/histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace hapticast {
namespace {

TEST(Histogram, IsZeroWhenEmpty) {
  const Histogram histogram;
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.quantile_ns(0.99), 0U);
}

TEST(Histogram, IsExactForSmallValues) {
  Histogram histogram;
  for (int i = 0; i < 16; ++i) histogram.add(i);
  EXPECT_EQ(histogram.quantile_ns(0.0), 0U);
  EXPECT_EQ(histogram.quantile_ns(0.5), 7U);
  EXPECT_EQ(histogram.quantile_ns(1.0), 15U);
}

TEST(Histogram, QuantilesAreWithinABucketOfTheTruth) {
  Histogram histogram;
  std::mt19937_64 random(5);
  std::vector<std::uint64_t> values;
  for (int i = 0; i < 20000; ++i) {
    values.push_back(random() >> (random() % 50 + 1));
    histogram.add(static_cast<std::int64_t>(values.back()));
  }
  std::sort(values.begin(), values.end());
  for (const double q : {0.0, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const auto truth = static_cast<double>(
        values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))]);
    const auto found = static_cast<double>(histogram.quantile_ns(q));
    EXPECT_GE(found, truth) << q;
    EXPECT_LE(found, truth * (1.0 + 1.0 / 16.0)) << q;
  }
  EXPECT_EQ(histogram.max_ns(), values.back());
}

TEST(Histogram, TakesTheExtremes) {
  Histogram histogram;
  histogram.add(-5);
  EXPECT_EQ(histogram.quantile_ns(1.0), 0U);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(histogram.quantile_ns(1.0),
            static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()));
}

}  // namespace
}  // namespace hapticast
