// SPDX-License-Identifier: MIT
#include "common/deepest_point.hpp"

#include <gtest/gtest.h>

namespace hapticast {
namespace {

TEST(DeepestPoint, IsTheCentreOfADisc) {
  const PixelRect rect{100, 50, 41, 41};
  std::vector<std::uint8_t> mask;
  for (int v = -20; v <= 20; ++v) {
    for (int u = -20; u <= 20; ++u) mask.push_back(u * u + v * v <= 400 ? 1 : 0);
  }
  EXPECT_LT((deepestPoint(rect, mask) - Vec2(120.5, 70.5)).norm(), 1.5);
}

TEST(DeepestPoint, LiesInTheThickPartAndNeverInAHole) {
  // A bar 30 x 3 with a 9 x 9 block at its end, which has a hole in its middle pixel.
  const PixelRect rect{0, 0, 39, 9};
  std::vector<std::uint8_t> mask(39 * 9, 0);
  for (int u = 0; u < 39; ++u) {
    for (int v = 0; v < 9; ++v)
      mask[static_cast<std::size_t>(v * 39 + u)] = u >= 30 || (v >= 3 && v < 6);
  }
  EXPECT_EQ(deepestPoint(rect, mask), Vec2(34.5, 4.5));
  mask[4 * 39 + 34] = 0;
  const Vec2 point = deepestPoint(rect, mask);
  EXPECT_GT(point.x(), 30.0);
  EXPECT_NE(point, Vec2(34.5, 4.5));
}

TEST(DeepestPoint, NothingGivesNothing) {
  EXPECT_EQ(deepestPoint({5, 5, 2, 2}, {0, 0, 0, 0}), Vec2(0.0, 0.0));
  EXPECT_EQ(deepestPoint({5, 5, 2, 2}, {1, 1, 1}), Vec2(0.0, 0.0));
  EXPECT_EQ(deepestPoint({5, 5, 0, 2}, {}), Vec2(0.0, 0.0));
  EXPECT_EQ(deepestPoint({5, 5, 1, 1}, {1}), Vec2(5.5, 5.5));
}

}  // namespace
}  // namespace hapticast
