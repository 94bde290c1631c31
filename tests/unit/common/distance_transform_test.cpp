// SPDX-License-Identifier: MIT
#include "common/relief/distance_transform.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace hapticast {
namespace {

TEST(DistanceTransform, EqualsBruteForceOnRandomMasks) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 60; ++trial) {
    const int width = 1 + static_cast<int>(random() % 23);
    const int height = 1 + static_cast<int>(random() % 19);
    const Vec2 step(0.25, trial % 2 == 0 ? 0.25 : 0.4);
    std::bernoulli_distribution covered(trial % 3 == 0 ? 0.02 : 0.3);
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(width * height));
    for (auto& pixel : mask) pixel = covered(random) ? 1 : 0;
    const NearestPixel result = findNearestPixel(mask, width, height, 1, step);
    const auto distance = [&](int i, int j) {
      const int rows = i / width - j / width;
      return std::hypot(step.x() * (i % width - j % width), step.y() * rows);
    };
    for (int i = 0; i < width * height; ++i) {
      double best = std::numeric_limits<double>::infinity();
      for (int j = 0; j < width * height; ++j) {
        if (mask[static_cast<std::size_t>(j)] != 0) best = std::min(best, distance(i, j));
      }
      const auto at = static_cast<std::size_t>(i);
      if (std::isinf(best)) {
        ASSERT_EQ(result.nearest[at], -1);
        ASSERT_TRUE(std::isinf(result.distance_mm[at]));
        continue;
      }
      ASSERT_NEAR(result.distance_mm[at], best, 1e-5);
      ASSERT_NEAR(distance(i, result.nearest[at]), best, 1e-5);
    }
  }
}

}  // namespace
}  // namespace hapticast
