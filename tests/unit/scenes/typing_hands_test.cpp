// SPDX-License-Identifier: MIT
// The real clip that comes with the repository: hands on a laptop (tests/data/typing_hands). Unlike
// the tests of the other real clips, these never skip.
#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "server/vision/vision.hpp"

namespace hapticast::server {
namespace {

constexpr const char* kClip = HAPTICAST_TESTS "/data/typing_hands";
const Vec2 kBackOfTheHand_px(167, 111);

std::vector<VisionResult> seeHands() {
  const auto source = openSource(kClip, 0.0);
  VisionSettings settings;
  settings.object_points = {{kBackOfTheHand_px}};
  Vision vision(source->info(), settings);
  vision.scan(*source, [](std::uint64_t, std::uint64_t) { return true; });
  std::vector<VisionResult> results;
  while (const auto frame = source->read()) {
    if (auto result = vision.push(*frame, mediaTime(frame->clip_time_s)))
      results.push_back(std::move(*result));
  }
  for (VisionResult& result : vision.flush()) results.push_back(std::move(result));
  return results;
}

/// Whether the pixel at (u, v) belongs to the relief.
bool isInside(const Relief& relief, int u, int v) {
  const int i = u - relief.rect.u;
  const int j = v - relief.rect.v;
  if (i < 0 || j < 0 || i >= relief.rect.width || j >= relief.rect.height) return false;
  return relief.mask[static_cast<std::size_t>(j * relief.rect.width + i)] != 0;
}

TEST(TypingHands, TheSourceReadsAllOfIt) {
  const auto source = openSource(kClip, 0.0);
  EXPECT_EQ(source->info().width_px, 320);
  EXPECT_EQ(source->info().height_px, 208);
  EXPECT_EQ(source->info().fps, 24.0);
  EXPECT_EQ(source->info().depth_kind, DepthKind::kMetric);
  ASSERT_TRUE(source->info().camera);
  EXPECT_DOUBLE_EQ(source->info().camera->cx_px, 190.503 + 0.5) << "of the cut, from pixel edges";
  std::uint64_t frames = 0;
  while (const auto frame = source->read()) {
    EXPECT_EQ(frame->index, frames++);
    EXPECT_EQ(frame->color.size(), cv::Size(320, 208));
    EXPECT_EQ(frame->depth.size(), cv::Size(320, 208));
    EXPECT_NEAR(cv::countNonZero(frame->depth), 0.58 * 320 * 208, 0.03 * 320 * 208);
  }
  EXPECT_EQ(frames, 48U);
}

TEST(TypingHands, TheHandIsOneObjectAllTheTimeAndEndsAtTheSleeve) {
  const std::vector<VisionResult> results = seeHands();
  ASSERT_EQ(results.size(), 48U);
  std::ptrdiff_t last_area_px = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    SCOPED_TRACE(i);
    ASSERT_EQ(results[i].frame.objects.size(), 1U);
    const HapticObject& object = results[i].frame.objects[0];
    EXPECT_EQ(object.id, results[0].frame.objects[0].id);
    ASSERT_TRUE(object.relief);
    const Relief& relief = *object.relief;
    const auto area_px =
        static_cast<std::ptrdiff_t>(relief.mask.size()) - std::ranges::count(relief.mask, 0);
    EXPECT_GT(area_px, 2000);
    EXPECT_LT(area_px, 4000);
    if (i > 0) {
      EXPECT_NEAR(double(area_px) / double(last_area_px), 1.0, 0.05);
    }
    last_area_px = area_px;
    EXPECT_TRUE(isInside(relief, 167, 111)) << "the back of the hand";
    EXPECT_FALSE(isInside(relief, 90, 115)) << "the sleeve";
    EXPECT_FALSE(isInside(relief, 180, 142)) << "the laptop's edge";
    EXPECT_FALSE(isInside(relief, 230, 90)) << "the other hand";
    EXPECT_FALSE(isInside(relief, 250, 30)) << "nothing";
  }
}

TEST(TypingHands, TheSentReliefCanBeTouched) {
  for (const VisionResult& result : seeHands()) {
    SCOPED_TRACE(result.frame.id);
    const HapticObject& object = result.frame.objects.at(0);
    const Relief& relief = *object.relief;
    const auto [least, most] = std::ranges::minmax(relief.height_mm);
    EXPECT_GE(least, 0.0F);
    EXPECT_LE(most, 30.0F);
    EXPECT_GT(most, 20.0F) << "flat";
    const Motion& motion = object.motion;
    EXPECT_TRUE(motion.position_mm.allFinite() && motion.acceleration_mm_s2.allFinite());
    EXPECT_LT(motion.velocity_mm_s.norm(), 50.0) << "the arm rests on its elbow";
    EXPECT_TRUE(object.impacts.empty());
  }
}

}  // namespace
}  // namespace hapticast::server
