// SPDX-License-Identifier: MIT
#include "server/vision/base/depth_scale_alignment.hpp"

#include <gtest/gtest.h>

#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

const cv::Size kPicture(320, 240);

// A room that falls back to the right, a box before it; seen from a camera at `pan_px`.
struct DrawnRoom {
  cv::Mat gray{kPicture, CV_8UC1};
  cv::Mat depth{kPicture, CV_32FC1};
  cv::Mat object = cv::Mat::zeros(kPicture, CV_8UC1);

  explicit DrawnRoom(double pan_px = 0.0, double nearer_mm = 0.0) {
    for (int v = 0; v < kPicture.height; ++v) {
      for (int u = 0; u < kPicture.width; ++u) {
        const double at = u + pan_px;
        gray.at<uchar>(v, u) = static_cast<uchar>(40 + 180 * test::paint(at, v));
        depth.at<float>(v, u) =
            static_cast<float>(900 + 2.5 * at + 1.5 * v + 40 * std::sin(at / 30));
      }
    }
    const cv::Rect box(120, 80, 80, 80);
    depth(box) = 700.0 - nearer_mm;
    object(box) = 255;
  }
};

cv::Mat hopped(const cv::Mat& depth, double scale, double shift) {
  return 1.0 / (cv::Mat(1.0 / depth) * scale + shift);
}

cv::Mat flickerNoise(cv::RNG& random, double sigma) {
  cv::Mat out(kPicture, CV_32FC1);
  random.fill(out, cv::RNG::NORMAL, 0.0, sigma);
  return out;
}

double largestOff(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF); }

TEST(DepthScaleAlignment, ScaleAndShiftOfAnEstimatorAreTakenOut) {
  cv::RNG random(7);
  for (int run = 0; run < 3; ++run) {
    const DrawnRoom room;
    DepthScaleAlignment flicker(DepthKind::kMetric);
    cv::Mat settled;
    for (int i = 0; i < 40; ++i) {
      const double scale = 1.0 + random.gaussian(0.03);
      const double shift = random.gaussian(0.03) / 2000;
      const cv::Mat seen = hopped(room.depth + flickerNoise(random, 0.5), scale, shift);
      const cv::Mat out = flicker.steady(seen, room.gray, room.object);
      if (i < 10) continue;
      EXPECT_TRUE(flicker.shown());
      if (settled.empty()) cv::blur(out, settled, {9, 9});
      cv::Mat soft;
      cv::blur(out, soft, {9, 9});
      EXPECT_LT(largestOff(soft, settled), 2.0) << i;  // raw: some 50 mm
    }
  }
}

TEST(DepthScaleAlignment, DepthOfAProgramIsAlignedFromTheSecondFrameOn) {
  const DrawnRoom room;
  cv::RNG random(11);
  for (const EstimatedDepth kind :
       {EstimatedDepth::kMetric, EstimatedDepth::kRelative, EstimatedDepth::kInverse}) {
    DepthScaleAlignment flicker(DepthKind::kMetric, kind);
    cv::Mat first;
    for (int i = 0; i < 12; ++i) {
      const double scale = 1.0 + random.gaussian(0.01);
      const double shift = random.gaussian(0.01);
      const cv::Mat seen = kind == EstimatedDepth::kInverse
                               ? hopped(room.depth, scale, shift / 1000)
                               : cv::Mat(room.depth * scale + 1000 * shift);
      const cv::Mat out = flicker.steady(seen, room.gray, room.object);
      if (i == 0) first = out.clone();
      EXPECT_LT(largestOff(out, first), 0.1) << i;  // raw: some 20 mm
    }
  }
}

TEST(DepthScaleAlignment, OfLevelsTooAndTheObjectKeepsItsOwnMotion) {
  cv::RNG random(8);
  DepthScaleAlignment flicker(DepthKind::kHeight);
  double first_mm = 0.0;
  double least = 1e9;
  for (int i = 0; i < 40; ++i) {
    const DrawnRoom room(0.0, 2.0 * i);
    cv::Mat levels;
    // Levels of 1.57 mm.
    const double scale = 1.0 + random.gaussian(0.03);
    cv::Mat((room.depth * scale + random.gaussian(8.0)) / 1.57).convertTo(levels, CV_32S);
    levels.convertTo(levels, CV_32F, 1.57);
    const cv::Mat out = flicker.steady(levels, room.gray, room.object);
    const double object_mm = cv::mean(out, room.object)[0];
    if (i == 10) first_mm = object_mm;
    if (i > 10) {
      EXPECT_NEAR(first_mm - object_mm, 2.0 * (i - 10), 3.0) << i;
    }
    least = std::min(least, object_mm);
  }
  EXPECT_LT(least, first_mm - 50);
}

TEST(DepthScaleAlignment, ASensorIsLeftAlone) {
  cv::RNG random(9);
  const DrawnRoom room;
  DepthScaleAlignment flicker(DepthKind::kMetric);
  for (int i = 0; i < 60; ++i) {
    const cv::Mat seen = room.depth + flickerNoise(random, 2.0);
    EXPECT_EQ(flicker.steady(seen, room.gray, room.object).data, seen.data);
  }
  EXPECT_FALSE(flicker.shown());
}

TEST(DepthScaleAlignment, ACameraThatMovesIsLeftAlone) {
  for (const double px : {0.5, 3.0, 8.0}) {
    DepthScaleAlignment flicker(DepthKind::kMetric);
    for (int i = 0; i < 60; ++i) {
      const DrawnRoom room(px * i);
      EXPECT_EQ(flicker.steady(room.depth, room.gray, room.object).data, room.depth.data) << px;
    }
  }
}

}  // namespace
}  // namespace hapticast::server
