// SPDX-License-Identifier: MIT
// Depth that is scaled to the size of the colour: where its edges are, on drawn scenes, and which
// values it may have. The first test prints the figures of server/source/README.md.
#include "server/source/scale/depth_scale.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>

#include "tests/unit/server/depth_edges.hpp"

namespace hapticast::server {
namespace {

constexpr float kMiddle_mm = 1050.0F;  // between shape and background

/// Returns the mean errors over shapes and seeds. `guided`: scaleDepth(), else the nearest pixel.
EdgeError measureEdges(cv::Size depth_size, bool mean, double contrast, bool guided) {
  EdgeError sum;
  int scenes = 0;
  for (const EdgeShape shape : {EdgeShape::kDisc, EdgeShape::kBar, EdgeShape::kHand}) {
    for (int seed = 0; seed < 3; ++seed, ++scenes) {
      const EdgeScene scene = drawEdgeScene(shape, {480, 360}, seed, contrast);
      const cv::Mat depth = sampleDepth(scene.depth, depth_size, mean);
      cv::Mat scaled;
      if (guided)
        scaled = scaleDepth(depth, DepthKind::kMetric, scene.color);
      else
        cv::resize(depth, scaled, scene.color.size(), 0.0, 0.0, cv::INTER_NEAREST_EXACT);
      const EdgeError error = compareBoundaries(scaled < kMiddle_mm, scene.near);
      sum.mean_px += error.mean_px;
      sum.q95_px += error.q95_px;
    }
  }
  return {sum.mean_px / scenes, sum.q95_px / scenes};
}

TEST(DepthScale, EdgesAreWithinHalfAPixelOfTheTrueOnes) {
  constexpr std::array<double, 4> kContrasts{120.0, 60.0, 30.0, 0.0};
  fmt::print("depth of half the size, error of its edges, px: mean (95 %)\n");
  fmt::print("{:<9} {:<8}", "sampled", "scaled");
  for (const double contrast : kContrasts) fmt::print(" {:>6.0f} levels", contrast);
  fmt::print("\n");
  for (const bool mean : {false, true}) {
    std::array<EdgeError, kContrasts.size()> nearest;
    for (const bool guided : {false, true}) {
      fmt::print("{:<9} {:<8}", mean ? "mean" : "pixel", guided ? "guided" : "nearest");
      for (std::size_t i = 0; i < kContrasts.size(); ++i) {
        const EdgeError error = measureEdges({240, 180}, mean, kContrasts[i], guided);
        fmt::print("   {:.2f} ({:.2f})", error.mean_px, error.q95_px);
        if (!guided) {
          nearest[i] = error;
          continue;
        }
        EXPECT_LE(error.mean_px, kContrasts[i] >= 60.0 ? 0.27 : 0.4) << kContrasts[i];
        EXPECT_LE(error.q95_px, 1.1) << kContrasts[i];
        EXPECT_LE(error.mean_px, nearest[i].mean_px + 0.05) << kContrasts[i];
      }
      fmt::print("\n");
    }
  }
}

TEST(DepthScale, EdgesOfMuchSmallerDepthAreBetterThanNearest) {
  for (const cv::Size size : {cv::Size(192, 144), cv::Size(120, 90), cv::Size(64, 48)}) {
    const double nearest = measureEdges(size, false, 60.0, false).mean_px;
    const double guided = measureEdges(size, false, 60.0, true).mean_px;
    fmt::print("depth of {} x {} to 480 x 360: nearest {:.2f} px, guided {:.2f} px\n", size.width,
               size.height, nearest, guided);
    EXPECT_LT(guided, 0.55 * nearest) << size;
  }
}

TEST(DepthScale, EveryValueIsOneOfTheDepthAndHolesStay) {
  EdgeScene scene = drawEdgeScene(EdgeShape::kHand, {320, 240}, 1, 60.0);
  cv::Mat depth = sampleDepth(scene.depth, {160, 120}, false);
  cv::RNG random(5);
  for (int i = 0; i < 800; ++i)
    depth.at<float>(random.uniform(0, depth.rows), random.uniform(0, depth.cols)) = 0.0F;
  const cv::Mat scaled = scaleDepth(depth, DepthKind::kMetric, scene.color);
  cv::Mat nearest;
  cv::resize(depth, nearest, scaled.size(), 0.0, 0.0, cv::INTER_NEAREST_EXACT);
  EXPECT_EQ(cv::countNonZero((scaled == 0.0F) != (nearest == 0.0F)), 0);
  for (int v = 0; v < scaled.rows; ++v) {
    for (int u = 0; u < scaled.cols; ++u) {
      const cv::Rect around(u / 2 - 2, v / 2 - 2, 5, 5);
      const cv::Mat part = depth(around & cv::Rect({0, 0}, depth.size()));
      ASSERT_GT(cv::countNonZero(part == scaled.at<float>(v, u)), 0) << u << ' ' << v;
    }
  }
}

TEST(DepthScale, LevelsOfZeroAreDepths) {
  cv::Mat depth(20, 20, CV_32FC1, cv::Scalar(0.0));
  depth.colRange(10, 20).setTo(200.0F);
  cv::Mat color(40, 40, CV_8UC3, cv::Scalar::all(30.0));
  color.colRange(19, 40).setTo(cv::Scalar::all(220.0));
  const cv::Mat scaled = scaleDepth(depth, DepthKind::kHeight, color);
  EXPECT_EQ(cv::countNonZero(scaled == 200.0F), 21 * 40) << "as the colours say";
  EXPECT_EQ(cv::countNonZero(scaled == 0.0F), 19 * 40);
  const cv::Mat metric = scaleDepth(depth, DepthKind::kMetric, color);
  EXPECT_EQ(cv::countNonZero(metric == 200.0F), 20 * 40) << "0 is not measured";
}

TEST(DepthScale, SmallerSizesAndEqualSizesHaveTheNearestPixel) {
  const EdgeScene scene = drawEdgeScene(EdgeShape::kDisc, {160, 120}, 2, 60.0);
  EXPECT_EQ(scaleDepth(scene.depth, DepthKind::kMetric, scene.color).data, scene.depth.data);
  cv::Mat small;
  cv::resize(scene.color, small, {80, 60}, 0.0, 0.0, cv::INTER_AREA);
  const cv::Mat scaled = scaleDepth(scene.depth, DepthKind::kMetric, small);
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 80; ++u) {
      const cv::Mat cell = scene.depth(cv::Rect(2 * u, 2 * v, 2, 2));
      ASSERT_GT(cv::countNonZero(cell == scaled.at<float>(v, u)), 0);
    }
  }
}

}  // namespace
}  // namespace hapticast::server
