// SPDX-License-Identifier: MIT
// Clean bodies near and far: no scale of a clip may cost them their rim.
#include <gtest/gtest.h>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/surface/enhance.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

class ScaleOfCleanBodies : public testing::TestWithParam<double> {
 protected:
  // What of `mask` is dropped, as a share, and the worst that is made of it: nominal mm, where the
  // body fills the workspace's depth of 30.
  struct Loss {
    double dropped = 0.0;
    double worst_mm = 0.0;
  };
  static Loss loss(const cv::Mat& depth, const cv::Mat& mask, bool exact) {
    const Surface surface =
        cleanSurface(depth, mask, measureNoise(depth), Method::kHapticast, exact);
    cv::Mat off;
    cv::absdiff(surface.depth, depth(surface.box), off);
    double worst = 0.0;
    double near = 0.0;
    double far = 0.0;
    cv::minMaxLoc(off, nullptr, &worst, nullptr, nullptr, surface.mask);
    cv::minMaxLoc(depth, &near, &far, nullptr, nullptr, mask);
    return {1.0 - double(cv::countNonZero(surface.measured)) / cv::countNonZero(mask),
            30.0 * worst / (far - near)};
  }
  static void expectWhole(const cv::Mat& depth, const cv::Mat& mask) {
    const Loss exact = loss(depth, mask, true);
    EXPECT_EQ(exact.dropped, 0.0);
    EXPECT_EQ(exact.worst_mm, 0.0);
    for (const int smaller_px : {0, 1, 2}) {  // masks of our own are off by so much
      const Loss own = loss(depth, smaller_px > 0 ? erodeBy(mask, smaller_px) : mask, false);
      EXPECT_LT(own.dropped, 0.002) << smaller_px;
      EXPECT_LT(own.worst_mm, 0.3) << smaller_px;
    }
  }
};

TEST_P(ScaleOfCleanBodies, ABallKeepsItsRim) {
  const double z_mm = GetParam();
  const test::BallScene scene{
      .radius_px = 80, .near_mm = z_mm, .bulge_mm = 0.25 * z_mm, .background_mm = 1.8 * z_mm};
  const FrameImages images = makeFrameImages(scene.frame(0, 160, 120), scene.info());
  expectWhole(images.depth, images.mask * 255);
  // As files have it: whole millimetres.
  cv::Mat rounded;
  images.depth.convertTo(rounded, CV_32S);
  rounded.convertTo(rounded, CV_32F);
  EXPECT_EQ(loss(rounded, images.mask * 255, true).dropped, 0.0);
}

TEST_P(ScaleOfCleanBodies, ASlopeKeepsItsRim) {
  const double z_mm = GetParam();
  cv::Mat depth(240, 320, CV_32FC1, cv::Scalar(3 * z_mm));
  cv::Mat mask = cv::Mat::zeros(240, 320, CV_8UC1);
  for (int v = 50; v < 190; ++v) {
    for (int u = 80; u < 230; ++u) {
      depth.at<float>(v, u) =
          static_cast<float>(z_mm * (1 + 0.006 * (u - 80) + 0.0021234 * (v - 50)));
      mask.at<uchar>(v, u) = 255;
    }
  }
  expectWhole(depth, mask);
}

INSTANTIATE_TEST_SUITE_P(FromAnArmsLengthToARoom, ScaleOfCleanBodies,
                         testing::Values(300.0, 800.0, 1500.0, 3000.0, 5000.0));

// A seam of mixed pixels between body and background is no rim, however even it is.
TEST(ScaleOfCleanBodies, ASeamOfMixedPixelsIsDroppedStill) {
  for (const int seam_px : {1, 2, 3}) {
    cv::Mat depth(200, 200, CV_32FC1, cv::Scalar(1500));
    cv::Mat mask = cv::Mat::zeros(200, 200, CV_8UC1);
    for (int v = 0; v < 200; ++v) {
      for (int u = 0; u < 200; ++u) {
        const double out_px = std::hypot(u - 100, v - 100) - 60.0;
        if (out_px < 2) mask.at<uchar>(v, u) = 255;  // two pixels too wide
        const double part = std::clamp(out_px / (seam_px + 1.0), 0.0, 1.0);
        depth.at<float>(v, u) = static_cast<float>(900 + 600 * part);
      }
    }
    const Surface surface =
        cleanSurface(depth, mask, measureNoise(depth), Method::kHapticast, false);
    double worst = 0.0;
    cv::minMaxLoc(surface.depth, nullptr, &worst, nullptr, nullptr, surface.mask);
    EXPECT_LT(worst, 1250.0) << seam_px;  // half-way and a little
  }
}

}  // namespace
}  // namespace hapticast::server
