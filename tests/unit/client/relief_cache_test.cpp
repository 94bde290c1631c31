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

TEST(ReliefCache, AMissingReliefIsThePreviousOneMovedWithTheObject) {
  ReliefCache cache;
  const Workspace workspace;
  cache.reset(workspace, Method::kHapticast);
  HapticObject object;
  object.id = 1;
  object.changed_in_frame = 1;
  object.relief = flatRelief(kResent_px);
  object.motion.position_mm = {4.0, 2.0, 5.0};
  ASSERT_TRUE(cache.resolve(testing::coded(object), 1).field);
  CodedObject moved = testing::coded(object);
  moved.changed_in_frame = 2;  // of frame 2 nothing came
  moved.relief = nullptr;
  const double pixel_mm = 1.0 / workspace.pixelsPerMm().x();
  moved.motion.position_mm += Vec3(10.0 * pixel_mm, -4.0 * pixel_mm, 1.5);
  const ReliefCache::Resolved carried = cache.resolve(moved, 3);
  ASSERT_TRUE(carried.field);
  EXPECT_EQ(carried.field->rect(), (PixelRect{110, 104, 40, 30}));
  EXPECT_EQ(carried.slices_lost, 1U);
  const SurfaceSample inside = carried.field->bilinear({130.0, 119.0});
  EXPECT_NEAR(inside.height_mm, 6.5, 0.01);
  EXPECT_EQ(cache.resolve(moved, 4).field, carried.field) << "prepared once";

  moved.motion.position_mm.x() += 1e5;
  moved.changed_in_frame = 5;
  EXPECT_FALSE(cache.resolve(moved, 6).field) << "out of the picture";
  moved.relief = testing::coded(object).relief;
  moved.changed_in_frame = 7;
  EXPECT_TRUE(cache.resolve(moved, 7).field);
  cache.forget();
  moved.relief = nullptr;
  EXPECT_FALSE(cache.resolve(moved, 8).field);
}

TEST(ReliefCacheRect, HoldsATurnedRelief) {
  const Workspace workspace;
  PosedRelief before{flatRelief({300, 200, 40, 20}), {}};
  before.motion.position_mm.head<2>() = workspace.toNominal({320.0, 210.0});
  Motion now = before.motion;
  now.angle_rad = 0.5 * M_PI;
  const PixelRect rect = warpRect(before, now, workspace);
  EXPECT_NEAR(rect.u, 310, 1);
  EXPECT_NEAR(rect.v, 190, 1);
  EXPECT_NEAR(rect.width, 20, 2);
  EXPECT_NEAR(rect.height, 40, 2);
}

}  // namespace
}  // namespace hapticast::client
