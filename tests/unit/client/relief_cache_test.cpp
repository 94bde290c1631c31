// SPDX-License-Identifier: MIT
#include "client/net/relief_cache.hpp"

#include <gtest/gtest.h>

#include "tests/support/coded.hpp"
#include "tests/support/flat_relief.hpp"

namespace hapticast::client {
namespace {

constexpr PixelRect kResent_px{100, 100, 40, 30};

TEST(ReliefCache, ASameReliefResentIsTheSameToTouch) {
  ReliefCache cache;
  cache.reset(Workspace{}, Method::kHapticast);
  std::uint64_t frame_id = 0;
  const auto fieldOf = [&](std::shared_ptr<const Relief> relief) {
    HapticObject object;
    object.id = 1;
    object.changed_in_frame = ++frame_id;
    object.relief = std::move(relief);
    return cache.resolve(testing::coded(object), frame_id).field;
  };
  const auto first = fieldOf(flatRelief(kResent_px));
  ASSERT_TRUE(first);
  EXPECT_EQ(fieldOf(flatRelief(kResent_px)), first);
  CodedObject unchanged;
  unchanged.id = 1;
  unchanged.changed_in_frame = frame_id;
  EXPECT_EQ(cache.resolve(unchanged, frame_id + 1).field, first) << "since the newer of the two";
  auto masked = flatRelief(kResent_px);
  masked->mask[0] = 0;
  const auto second = fieldOf(masked);
  EXPECT_NE(second, first);
  const auto third = fieldOf(flatRelief(kResent_px, 5.5F));
  EXPECT_NE(third, second);
  EXPECT_NE(fieldOf(flatRelief({101, 100, 40, 30}, 5.5F)), third);
}

}  // namespace
}  // namespace hapticast::client
