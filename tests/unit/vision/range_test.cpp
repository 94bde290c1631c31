// SPDX-License-Identifier: MIT
#include "server/vision/surface/range.hpp"

#include <gtest/gtest.h>

#include "server/pipeline/plan_log.hpp"
#include "server/vision/vision.hpp"
#include "tests/scenes/ball_scene.hpp"
#include "tests/support/log_lines.hpp"

namespace hapticast::server {
namespace {

const DepthNoise kSensor{{0.7}, 0.0};
const cv::Size kBox(120, 100);

// A bulging thing from `front_mm` to 80 mm behind it, with noise.
Surface thing(double front_mm, cv::RNG& random) {
  Surface out;
  out.box = cv::Rect({50, 40}, kBox);
  out.mask = cv::Mat(kBox, CV_8UC1, cv::Scalar(255));
  out.measured = out.mask.clone();
  out.depth.create(kBox, CV_32FC1);
  for (int v = 0; v < kBox.height; ++v) {
    for (int u = 0; u < kBox.width; ++u) {
      const double off = std::hypot(u / 60.0 - 1, v / 50.0 - 1) / std::sqrt(2.0);
      out.depth.at<float>(v, u) =
          static_cast<float>(front_mm + 80 * off * off + random.gaussian(0.7));
    }
  }
  return out;
}

double share(const MappedRange& mapped, double span_mm) {
  return span_mm / (mapped.range.far_mm - mapped.range.near_mm);
}

TEST(Range, BackgroundPixelsInMasksDoNotStretchIt) {
  cv::RNG random(3);
  for (int run = 0; run < 5; ++run) {
    RangeFinder finder;
    for (int i = 0; i < 60; ++i) {
      Surface surface = thing(600 + random.uniform(-5.0, 5.0), random);
      // In two frames of five some background, in some a hand before it.
      if (random.uniform(0, 5) < 2)
        surface.depth(cv::Rect(0, 0, random.uniform(5, 35), 30)) = random.uniform(1000.0, 2700.0);
      if (random.uniform(0, 5) < 1)
        surface.depth(cv::Rect(90, 60, random.uniform(5, 25), 30)) = random.uniform(300.0, 500.0);
      finder.add(1, surface, kSensor);
    }
    const MappedRange mapped = finder.range(0.05).value();
    EXPECT_GT(share(mapped, 80), 0.4) << run;
    EXPECT_LT(mapped.range.near_mm, 598);
    EXPECT_GT(mapped.range.far_mm, 660);
  }
}

TEST(Range, HoldsObjectsThatMoveInDepthAndReportsAWideRange) {
  cv::RNG random(4);
  RangeFinder finder;
  for (int i = 0; i < 100; ++i) finder.add(1, thing(500 + 4 * i, random), kSensor);
  const MappedRange mapped = finder.range(0.05).value();
  EXPECT_LT(mapped.range.near_mm, 505);
  EXPECT_GT(mapped.range.far_mm, 940);
  EXPECT_TRUE(mapped.wide);
  EXPECT_NEAR(mapped.usual_mm, 62, 12);
  LogLines log;
  DepthRangeLog range_log;
  range_log.log(std::nullopt);
  EXPECT_EQ(log.count(), 0);
  range_log.log(mapped);
  range_log.log(mapped);
  EXPECT_EQ(log.count(), 2);
  EXPECT_NE(log.text().find("--not"), std::string::npos);
}

TEST(Range, EveryObjectHasItsOwnUsualDepth) {
  cv::RNG random(5);
  RangeFinder finder;
  for (int i = 0; i < 20; ++i) {
    finder.add(1, thing(600, random), kSensor);
    finder.add(2, thing(900, random), kSensor);
  }
  const MappedRange mapped = finder.range(0.05).value();
  EXPECT_LT(mapped.range.near_mm, 602);
  EXPECT_GT(mapped.range.far_mm, 950);
}

// Eight bits of a whole room leave a thing a few levels: these become the heights.
TEST(Range, AnObjectInEightBitDepthOfARoomIsTall) {
  test::BallScene scene;
  scene.kind = DepthKind::kMetric;
  for (const double level_mm : {6.0, 9.0}) {
    SourceInfo info = scene.info();
    info.depth_kind = DepthKind::kHeight;
    Vision vision(info, {});
    std::vector<VisionResult> results;
    for (std::uint64_t i = 0; i < 8; ++i) {
      RgbdFrame frame = scene.frame(i, 150, 120);
      cv::Mat levels;
      cv::Mat(230 - (frame.depth - 500) / level_mm).convertTo(levels, CV_8U);
      levels.convertTo(frame.depth, CV_32F);
      if (auto result = vision.push(frame, mediaTime(double(i) / 25)))
        results.push_back(std::move(*result));
    }
    for (VisionResult& result : vision.flush()) results.push_back(std::move(result));
    ASSERT_TRUE(vision.mapped().has_value());
    // A live source keeps half of the range for what is to come.
    const auto& heights = results.back().frame.objects.at(0).relief->height_mm;
    EXPECT_GT(*std::max_element(heights.begin(), heights.end()), 14.0F) << level_mm;
  }
}

TEST(Range, TheAuthorsRangeHolds) {
  SourceInfo info = test::BallScene().info();
  VisionSettings settings;
  settings.depth_range = DepthRange{500, 900};
  EXPECT_EQ(Vision(info, settings).mapped()->range.far_mm, 900);
  settings.map_range = DepthRange{600, 700};
  EXPECT_EQ(Vision(info, settings).mapped()->range.far_mm, 700);
  // Of 8-bit depth --depth-range only defines the levels.
  info.depth_kind = DepthKind::kHeight;
  EXPECT_EQ(Vision(info, settings).mapped()->range.far_mm, 700);
  settings.map_range.reset();
  EXPECT_FALSE(Vision(info, settings).mapped().has_value());
  settings.method = Method::kThesis;
  EXPECT_EQ(Vision(info, settings).mapped()->range.far_mm, 900);
}

// A few pixels of a far background inside the mask make a pit, but do not bend what is beside it.
TEST(Range, AFarBackgroundDoesNotBendTheSurfaceBesideIt) {
  cv::RNG random(6);
  const Surface clean = thing(600, random);
  Surface leaky = clean;
  leaky.depth = clean.depth.clone();
  const cv::Rect leak(50, 40, 6, 6);
  leaky.depth(leak) = 2500.0;
  const DepthRange range{590, 690};
  const Workspace workspace{.width_px = 320, .height_px = 240};
  const auto a = makeRelief(clean, range, workspace, Method::kHapticast);
  const auto b = makeRelief(leaky, range, workspace, Method::kHapticast);
  for (int v = 0; v < kBox.height; ++v) {
    for (int u = 0; u < kBox.width; ++u) {
      const cv::Rect near(leak.x - 5, leak.y - 5, leak.width + 10, leak.height + 10);
      const auto at = static_cast<std::size_t>(v * kBox.width + u);
      const float off = std::abs(a->height_mm[at] - b->height_mm[at]);
      EXPECT_TRUE(near.contains({u, v}) || off < 0.1F) << u << ' ' << v << ' ' << off;
      EXPECT_TRUE(leak.contains({u, v}) || b->height_mm[at] < a->height_mm[at] + 3.0F);
    }
  }
}

}  // namespace
}  // namespace hapticast::server
