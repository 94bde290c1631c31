// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "server/vision/surface/layer_cutter.hpp"

namespace hapticast::server {
namespace {

constexpr double kGap_mm = 10.0;
const cv::Size kFurSize(160, 140);

// A furry body with an arm before it, a third of it not measured and filled in badly.
Surface furry(cv::RNG& random, const cv::Point& at, double arm_nearer_mm, double fur_mm = 1.2,
              float holes_above = 0.06F) {
  Surface out;
  out.box = cv::Rect(at, kFurSize);
  out.mask = cv::Mat(kFurSize, CV_8UC1, cv::Scalar(255));
  out.depth.create(kFurSize, CV_32FC1);
  cv::Mat fur(kFurSize, CV_32FC1);
  random.fill(fur, cv::RNG::NORMAL, 0.0, fur_mm);
  for (int v = 0; v < kFurSize.height; ++v) {
    for (int u = 0; u < kFurSize.width; ++u)
      out.depth.at<float>(v, u) =
          static_cast<float>(800 + 0.5 * std::abs(u - 80)) + fur.at<float>(v, u);
  }
  out.depth(cv::Rect(60, 40, 40, 70)) -= arm_nearer_mm;
  cv::Mat holes(kFurSize, CV_32FC1);
  random.fill(holes, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(holes, holes, {}, 2.5);
  out.measured = (holes < double(holes_above)) & out.mask;
  cv::Mat bad(kFurSize, CV_32FC1);
  random.fill(bad, cv::RNG::NORMAL, 0.0, 12.0);
  cv::add(out.depth, bad, out.depth, out.measured == 0);
  return out;
}

// Names over the picture, layer + 1.
cv::Mat listNames(const std::vector<Surface>& layers) {
  cv::Mat out = cv::Mat::zeros(300, 400, CV_8UC1);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (!layers[i].box.empty()) out(layers[i].box).setTo(double(i + 1), layers[i].mask);
  }
  return out;
}

TEST(LayerNames, HardlyAPixelOfMovingFurChangesItsLayer) {
  for (const double arm_mm : {0.0, 60.0}) {
    cv::RNG random(11);
    LayerCutter cutter;
    cv::Mat last;
    double changed = 0.0;
    for (int i = 0; i < 50; ++i) {
      const cv::Point at(20 + 2 * i, 30 + i % 7);
      const cv::Mat names = listNames(cutter.cut(furry(random, at, arm_mm), kGap_mm));
      const cv::Mat own = names(cv::Rect(at, kFurSize)).clone();
      if (i > 5) changed += cv::countNonZero(own != last) / static_cast<double>(own.total()) / 44.0;
      last = own;
      EXPECT_EQ(cv::countNonZero(own == 2) > 0, arm_mm > 0) << i;
    }
    EXPECT_LT(changed, 0.01) << arm_mm;
  }
}

// The arm's step is hardly more than the noise: cuts come and go, and pieces join and part.
TEST(LayerNames, HardlyAPixelOfWildFurChangesItsLayer) {
  for (const double arm_mm : {12.0, 16.0, 25.0, 40.0}) {
    cv::RNG random(17);
    LayerCutter cutter;
    cv::Mat last;
    double changed = 0.0;
    for (int i = 0; i < 60; ++i) {
      const cv::Point at(20 + 3 * i, 30 + 4 * (i % 3));
      const Surface fur = furry(random, at, arm_mm, 2.4, 0.0F);
      const cv::Mat names = listNames(cutter.cut(fur, kGap_mm));
      const cv::Mat own = names(cv::Rect(at, kFurSize)).clone();
      if (i > 0) changed += cv::countNonZero(own != last) / static_cast<double>(own.total()) / 59.0;
      last = own;
    }
    EXPECT_LT(changed, 0.002) << arm_mm;
  }
}

// Noise of an estimator lasts for some frames: the arm is there for four frames, then for four not.
TEST(LayerNames, ALayerThatComesAndGoesForFourFramesDoesNotFlicker) {
  cv::RNG random(19);
  LayerCutter cutter;
  cv::Mat last;
  double changed = 0.0;
  for (int i = 0; i < 60; ++i) {
    const cv::Point at(20 + 3 * i, 30);
    const double arm_mm = i / 4 % 2 == 0 ? 30.0 : 0.0;
    const cv::Mat names = listNames(cutter.cut(furry(random, at, arm_mm, 2.4), kGap_mm));
    const cv::Mat own = names(cv::Rect(at, kFurSize)).clone();
    if (i > 0) changed += cv::countNonZero(own != last) / static_cast<double>(own.total()) / 59.0;
    last = own;
  }
  EXPECT_LT(changed, 0.005);
}

TEST(LayerNames, StayWhenTheOrderOfDepthsChanges) {
  cv::RNG random(12);
  LayerCutter cutter;
  const cv::Point at(40, 50);
  const cv::Rect arm = cv::Rect(70, 50, 20, 50) + at;
  const int name = listNames(cutter.cut(furry(random, at, 60), kGap_mm)).at<uchar>(arm.tl());
  EXPECT_EQ(name, 1);  // what is nearest begins with the first
  for (int i = 0; i < 6; ++i) {
    const cv::Mat names = listNames(cutter.cut(furry(random, at, -60), kGap_mm));
    EXPECT_GT(cv::countNonZero(names(arm) == name), 0.95 * arm.area()) << i;
  }
}

TEST(LayerNames, ALayerThatGoesLeavesTheOthersTheirNames) {
  cv::RNG random(13);
  LayerCutter cutter;
  const cv::Point at(40, 50);
  (void)cutter.cut(furry(random, at, 60), kGap_mm);
  cv::Mat names;
  for (int i = 0; i < 12; ++i) names = listNames(cutter.cut(furry(random, at, 0), kGap_mm));
  EXPECT_EQ(cv::countNonZero(names == 2), kFurSize.area());
}

}  // namespace
}  // namespace hapticast::server
