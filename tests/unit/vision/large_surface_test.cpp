// SPDX-License-Identifier: MIT
// Surfaces of large pictures, whose smooth steps work at a reduced size, against the drawn truth
// and against the same surface at full size.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/reduction.hpp"
#include "server/vision/surface/layer_cutter.hpp"

namespace hapticast::server {
namespace {

const cv::Size kLargePicture(1920, 1080);
const cv::Rect kEggBox(500, 140, 900, 800);  // of the object, not wide enough for a reduction
constexpr DepthRange kEggRange{640.0, 800.0};

// An egg with bumps before a wall, as a sensor sees it: noise, holes and mixed pixels at the rim.
struct LargeEgg {
  cv::Mat truth, depth, mask;
};
LargeEgg drawLargeEgg() {
  LargeEgg out{cv::Mat(kLargePicture, CV_32FC1, cv::Scalar(1200)),
               {},
               cv::Mat::zeros(kLargePicture, CV_8UC1)};
  for (int v = kEggBox.y; v < kEggBox.br().y; ++v) {
    for (int u = kEggBox.x; u < kEggBox.br().x; ++u) {
      const double x = (u - 950) / 370.0;
      const double y = (v - 540) / 300.0;
      const double left = 1 - x * x - y * y;
      if (left <= 0) continue;
      out.mask.at<uchar>(v, u) = 255;
      out.truth.at<float>(v, u) = static_cast<float>(760 - 90 * std::sqrt(left) +
                                                     3 * std::sin(u / 40.0) * std::cos(v / 55.0));
    }
  }
  cv::RNG random(5);
  cv::Mat noise(kLargePicture, CV_32FC1);
  cv::Mat holes(kLargePicture, CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.5);
  random.fill(holes, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(holes, holes, {}, 6.0);
  cv::GaussianBlur(out.truth, out.depth, {5, 5}, 1.0);
  out.depth += noise;
  out.depth.setTo(0, holes > 0.06);
  return out;
}

// Returns the rms error of the heights more than 3 px inside, mm.
double reliefErrorOf(const Surface& surface, const cv::Point& corner, const LargeEgg& drawn) {
  Workspace workspace;
  workspace.width_px = kLargePicture.width;
  workspace.height_px = kLargePicture.height;
  const auto relief = makeRelief(surface, kEggRange, workspace, Method::kHapticast, true);
  cv::Mat inside;
  cv::erode(drawn.mask, inside, cv::Mat::ones(7, 7, CV_8UC1));
  double square = 0.0;
  double count = 0.0;
  for (int v = 0; v < relief->rect.height; ++v) {
    for (int u = 0; u < relief->rect.width; ++u) {
      const cv::Point at = cv::Point(u + relief->rect.u, v + relief->rect.v) + corner;
      if (inside.at<uchar>(at) == 0) continue;
      const double true_mm = workspace.depth_mm *
                             (kEggRange.far_mm - double(drawn.truth.at<float>(at))) /
                             (kEggRange.far_mm - kEggRange.near_mm);
      const auto index = static_cast<std::size_t>(v * relief->rect.width + u);
      square += std::pow(double(relief->height_mm[index]) - true_mm, 2);
      count += 1.0;
    }
  }
  return std::sqrt(square / count);
}

TEST(LargeSurface, IsAsExactAtAReducedSizeAsAtFullSize) {
  const LargeEgg drawn = drawLargeEgg();
  const DepthNoise noise = measureNoise(drawn.depth);
  const Surface reduced = cleanSurface(drawn.depth, drawn.mask, noise, Method::kHapticast);
  const Surface full = cleanSurface(drawn.depth(kEggBox).clone(), drawn.mask(kEggBox).clone(),
                                    noise, Method::kHapticast);
  ASSERT_EQ(reduced.reduction, 3);
  ASSERT_EQ(full.reduction, 1);
  ASSERT_EQ(reduced.box, full.box + kEggBox.tl());
  const double error_mm = reliefErrorOf(reduced, {}, drawn);
  EXPECT_LT(error_mm, 0.25);
  EXPECT_LT(error_mm, 1.01 * reliefErrorOf(full, kEggBox.tl(), drawn));
  // The background is rejected alike.
  EXPECT_LT(cv::countNonZero(reduced.measured != full.measured), 0.002 * full.box.area());
}

TEST(LargeSurface, IsCutAlongTheSameEdgesAsAtFullSize) {
  LargeEgg drawn = drawLargeEgg();
  const cv::Rect arm(820, 420, 200, 330);
  drawn.depth(arm).setTo(0, drawn.depth(arm) < 600);
  cv::Mat nearer = drawn.depth(arm) - 60.0;
  nearer.copyTo(drawn.depth(arm), drawn.depth(arm) > 0);
  const DepthNoise noise = measureNoise(drawn.depth);
  Surface surface = cleanSurface(drawn.depth, drawn.mask, noise, Method::kHapticast);
  ASSERT_EQ(surface.reduction, 3);
  const std::vector<Surface> reduced = LayerCutter().cut(surface, 20.0);
  surface.reduction = 1;
  const std::vector<Surface> full = LayerCutter().cut(surface, 20.0);
  ASSERT_EQ(reduced.size(), 2);
  ASSERT_EQ(full.size(), 2);
  const auto overPicture = [](const Surface& layer) {
    cv::Mat out = cv::Mat::zeros(kLargePicture, CV_8UC1);
    layer.mask.copyTo(out(layer.box));
    return out;
  };
  const int different = cv::countNonZero(overPicture(reduced[0]) != overPicture(full[0]));
  EXPECT_LT(different, 0.01 * arm.area());
}

TEST(LargeSurface, ReductionBeginsAboveAnAreaInAWidePicture) {
  EXPECT_EQ(computeReduction({640, 480}, {640, 480}, 90e3), 1);
  EXPECT_EQ(computeReduction({300, 300}, {1920, 1080}, 90e3), 1);
  EXPECT_EQ(computeReduction({500, 500}, {1920, 1080}, 90e3), 2);
  EXPECT_EQ(computeReduction({900, 900}, {1920, 1080}, 90e3), 3);
  EXPECT_EQ(computeReduction({900, 700}, {1280, 720}, 90e3), 2);
}

}  // namespace
}  // namespace hapticast::server
