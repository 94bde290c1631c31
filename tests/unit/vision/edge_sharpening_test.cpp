// SPDX-License-Identifier: MIT
#include "server/vision/base/edge_sharpening.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {
namespace {

/// A ball of another colour before a wall or a table.
struct SoftScene {
  cv::Mat color = cv::Mat(240, 320, CV_8UC3, cv::Scalar(50, 60, 70));
  cv::Mat depth = cv::Mat(240, 320, CV_32FC1);
  cv::Mat soft;
  cv::Mat ball = cv::Mat::zeros(240, 320, CV_8UC1);

  explicit SoftScene(double table_mm_px, int soft_px, std::uint64_t seed = 1) {
    cv::RNG random(seed);
    const cv::Point2d middle(random.uniform(120.0, 200.0), random.uniform(90.0, 150.0));
    for (int v = 0; v < 240; ++v) {
      for (int u = 0; u < 320; ++u) {
        depth.at<float>(v, u) = static_cast<float>(1200.0 - table_mm_px * v);
        const double away = std::hypot(u - middle.x, v - middle.y);
        if (away >= 40.0) continue;
        depth.at<float>(v, u) = static_cast<float>(780.0 - std::sqrt(1600.0 - away * away));
        color.at<cv::Vec3b>(v, u) = {20, 100, 200};
        ball.at<unsigned char>(v, u) = 255;
      }
    }
    cv::blur(depth, soft, {soft_px, soft_px}, {-1, -1}, cv::BORDER_REPLICATE);
  }
  /// Share of the pixels around the edge that are nearer to the wrong side.
  [[nodiscard]] double wrongShare(const cv::Mat& got) const {
    cv::Mat wide;
    cv::Mat narrow;
    cv::dilate(ball, wide, cv::Mat::ones(25, 25, CV_8UC1));
    cv::erode(ball, narrow, cv::Mat::ones(25, 25, CV_8UC1));
    int wrong = 0;
    int all = 0;
    for (int v = 0; v < got.rows; ++v) {
      for (int u = 0; u < got.cols; ++u) {
        if (wide.at<unsigned char>(v, u) == narrow.at<unsigned char>(v, u)) continue;
        ++all;
        wrong += std::abs(got.at<float>(v, u) - depth.at<float>(v, u)) > 100.0F ? 1 : 0;
      }
    }
    return double(wrong) / all;
  }
};

TEST(EdgeSharpening, SoftEdgesReturnToTheColours) {
  for (const double table_mm_px : {0.0, 1.0}) {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const SoftScene scene(table_mm_px, 15, seed);
      EXPECT_GT(scene.wrongShare(scene.soft), 0.1);
      EXPECT_LT(scene.wrongShare(sharpenEdges(scene.soft, scene.color)), 0.02) << table_mm_px;
    }
  }
}

TEST(EdgeSharpening, WithoutColoursTheMiddleOfTheRampDecides) {
  SoftScene scene(0.0, 15);
  scene.color.setTo(cv::Scalar(50, 60, 70));
  EXPECT_LT(scene.wrongShare(sharpenEdges(scene.soft, scene.color)), 0.15);
}

TEST(EdgeSharpening, ATableAndMissingDepthStay) {
  SoftScene scene(2.0, 1);
  cv::Mat table = scene.depth.clone();
  for (int v = 0; v < 240; ++v) table.row(v).setTo(1200.0 - 2.0 * v);
  EXPECT_EQ(sharpenEdges(table, scene.color).data, table.data);
  const cv::Mat nothing = cv::Mat::zeros(240, 320, CV_32FC1);
  EXPECT_EQ(sharpenEdges(nothing, scene.color).data, nothing.data);
}

}  // namespace
}  // namespace hapticast::server
