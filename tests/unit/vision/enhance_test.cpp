// SPDX-License-Identifier: MIT
#include "server/vision/surface/enhance.hpp"

#include <gtest/gtest.h>

#include <random>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/surface/quadratic_fit.hpp"
#include "server/vision/surface/range.hpp"
#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

constexpr DepthRange kRange{600, 900};
const Workspace kWorkspace{.width_px = 640, .height_px = 480};

cv::Mat discMask(int size, double radius) {
  cv::Mat mask = cv::Mat::zeros(size, size, CV_8UC1);
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u) {
      if (std::hypot(u - size / 2, v - size / 2) < radius) mask.at<uchar>(v, u) = 255;
    }
  }
  return mask;
}

cv::Mat painted(int size, const std::function<double(int, int)>& depth) {
  cv::Mat out(size, size, CV_32FC1);
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u) out.at<float>(v, u) = static_cast<float>(depth(u, v));
  }
  return out;
}

// Largest error of the relief against the depth it should show, over pixels at least `inset` inside
// the mask.
double worstError(const Relief& relief, const cv::Mat& mask,
                  const std::function<double(int, int)>& depth, int inset) {
  const cv::Mat inner = inset > 0 ? erodeBy(mask, inset) : mask;
  double worst = 0;
  for (int v = 0; v < relief.rect.height; ++v) {
    for (int u = 0; u < relief.rect.width; ++u) {
      if (inner.at<uchar>(v + relief.rect.v, u + relief.rect.u) == 0) continue;
      const auto height =
          double(relief.height_mm[static_cast<std::size_t>(v * relief.rect.width + u)]);
      const double truth = (kRange.far_mm - depth(u + relief.rect.u, v + relief.rect.v)) / 300 * 30;
      worst = std::max(worst, std::abs(height - truth));
    }
  }
  return worst;
}

const DepthNoise kNoise{{1.0}, 0.0};

TEST(Enhance, TheFitTreatsBothSidesAlike) {
  cv::RNG random(7);
  cv::Mat values(40, 50, CV_32FC1);
  random.fill(values, cv::RNG::NORMAL, 10.0, 1.0);
  cv::Mat mask = cv::Mat::zeros(values.size(), CV_8UC1);
  cv::circle(mask, {22, 20}, 15, 255, cv::FILLED);
  const cv::Mat fitted = fitQuadratic(values, mask, 2.0);
  for (const int axis : {0, 1}) {
    cv::Mat flipped;
    cv::Mat flipped_mask;
    cv::flip(values, flipped, axis);
    cv::flip(mask, flipped_mask, axis);
    cv::Mat back;
    cv::flip(fitQuadratic(flipped, flipped_mask, 2.0), back, axis);
    EXPECT_LT(cv::norm(fitted, back, cv::NORM_INF, mask), 1e-3) << axis;
  }
}

TEST(Enhance, KeepsAPlaneExactlyUpToTheRim) {
  const cv::Mat mask = discMask(120, 45);
  const auto plane = [](int u, int v) { return 700 + 0.8 * u - 0.3 * v; };
  const Surface surface = cleanSurface(painted(120, plane), mask, kNoise, Method::kHapticast);
  const auto relief = makeRelief(surface, kRange, kWorkspace, Method::kHapticast);
  EXPECT_EQ(relief->rect, (PixelRect{16, 16, 89, 89}));
  EXPECT_LT(worstError(*relief, mask, plane, 0), 1e-3);
}

TEST(Enhance, HasNoCurvatureBias) {
  const cv::Mat mask = discMask(160, 60);
  const auto bowl = [](int u, int v) {
    return 680 + 0.02 * ((u - 80) * (u - 80) + (v - 80) * (v - 80));
  };
  cv::Mat depth = painted(160, bowl);
  depth.setTo(1500, mask == 0);
  const Surface surface = cleanSurface(depth, mask, kNoise, Method::kHapticast);
  const auto relief = makeRelief(surface, kRange, kWorkspace, Method::kHapticast);
  EXPECT_LT(worstError(*relief, mask, bowl, 9), 1e-3);
  EXPECT_LT(worstError(*relief, mask, bowl, 0), 0.05);
}

TEST(Enhance, FillsHolesFromTheObject) {
  const cv::Mat mask = discMask(160, 60);
  const auto plane = [](int u, int v) { return 720 + 0.5 * u + 0.2 * v; };
  cv::Mat depth = painted(160, plane);
  cv::circle(depth, {80, 80}, 9, 0, cv::FILLED);
  cv::rectangle(depth, cv::Rect(60, 110, 25, 3), 0, cv::FILLED);
  const Surface surface = cleanSurface(depth, mask, kNoise, Method::kHapticast);
  EXPECT_EQ(cv::countNonZero(surface.measured & (surface.depth <= 0)), 0);
  EXPECT_LT(
      worstError(*makeRelief(surface, kRange, kWorkspace, Method::kHapticast), mask, plane, 0),
      0.15);
}

TEST(Enhance, RejectsBackgroundDepthAtTheRim) {
  const cv::Mat mask = discMask(160, 60);
  const cv::Mat inner = discMask(160, 57.5);
  const auto object = [](int, int) { return 700.0; };
  cv::Mat depth = painted(160, [](int, int) { return 1500.0; });
  depth.setTo(700, inner);  // the mask is 2.5 px too large for the depth
  const Surface surface = cleanSurface(depth, mask, kNoise, Method::kHapticast);
  EXPECT_LT(
      worstError(*makeRelief(surface, kRange, kWorkspace, Method::kHapticast), mask, object, 0),
      0.05);
  const Surface raw = cleanSurface(depth, mask, kNoise, Method::kThesis);
  EXPECT_GT(worstError(*makeRelief(raw, kRange, kWorkspace, Method::kThesis), mask, object, 0),
            5.0);
}

TEST(Enhance, DropsLonelyPixels) {
  const cv::Mat mask = discMask(160, 60);
  const auto object = [](int, int) { return 700.0; };
  cv::Mat depth = painted(160, object);
  depth.at<float>(80, 80) = 640;
  depth.at<float>(50, 90) = 880;
  const Surface surface = cleanSurface(depth, mask, kNoise, Method::kHapticast);
  EXPECT_LT(
      worstError(*makeRelief(surface, kRange, kWorkspace, Method::kHapticast), mask, object, 0),
      0.01);
}

TEST(Enhance, SmoothsNoiseInsideTheMask) {
  const cv::Mat mask = discMask(160, 60);
  const auto object = [](int, int) { return 700.0; };
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 2.0);
  const cv::Mat depth = painted(160, [&](int, int) { return 700 + noise(random); });
  const auto relief = makeRelief(cleanSurface(depth, mask, {{2.0}, 0.0}, Method::kHapticast),
                                 kRange, kWorkspace, Method::kHapticast);
  // 2 mm of depth is 0.2 mm of height; the fit leaves well under half of it at the worst pixel of
  // the interior.
  EXPECT_LT(worstError(*relief, mask, object, 9), 0.2);
}

TEST(Enhance, ExactDepthAndRoundedDepthAreClean) {
  EXPECT_FALSE((DepthNoise{{1.5}, 0.0}).clean(700));
  EXPECT_TRUE((DepthNoise{{0.03}, 0.0}).clean(700));
  EXPECT_TRUE((DepthNoise{{0.95}, 1.57, true}).clean(700));
  EXPECT_FALSE((DepthNoise{{0.6}, 1.0, false}).clean(700));  // what a sensor in whole mm reads
  EXPECT_FALSE((DepthNoise{{1.9}, 1.57, true}).clean(700));
}

TEST(Enhance, DepthNearerThanTheScanIsNotNoisier) {
  cv::RNG random(3);
  const cv::Mat depth =
      painted(120, [&](int u, int v) { return 620.0 + 0.1 * u + 0.2 * v + random.gaussian(0.05); });
  const DepthNoise noise = measureNoise(depth);
  EXPECT_NEAR(noise.at(620), 0.05, 0.01);
  EXPECT_EQ(noise.at(300), noise.at(620));
  EXPECT_EQ(noise.at(2000), noise.at(620));
  EXPECT_FALSE(measureNoise(cv::Mat::zeros(120, 120, CV_32FC1)).clean(300));
}

// Height of a ball of `radius_px` over a 640x480 picture (0.25 mm a pixel), its middle at (u, v).
cv::Mat ballHeights(double radius_px, double u, double v) {
  return painted(280, [&](int i, int j) {
    const double square =
        radius_px * radius_px - std::pow(i + 0.5 - u, 2) - std::pow(j + 0.5 - v, 2);
    return square > 0 ? 29.0 / 120 * std::sqrt(square) + 0.5 : 0.0;
  });
}

// As 255 levels over 30 mm.
cv::Mat buildLevels(const cv::Mat& heights_mm) {
  cv::Mat levels = heights_mm * (255.0 / 30.0);
  for (float& level : cv::Mat_<float>(levels)) level = std::max(0.0F, std::round(level));
  return levels;
}

struct Rms {
  double inside = 0;  // mm, 5 px and more from the rim
  double rim = 0;
};

Rms rmsError(const cv::Mat& heights, const cv::Mat& truth, const cv::Mat& mask) {
  const cv::Mat inner = erodeBy(mask, 5);
  const auto rms = [&](const cv::Mat& where) {
    return cv::norm(heights, truth, cv::NORM_L2, where) / std::sqrt(cv::countNonZero(where));
  };
  return {rms(inner), rms(mask & ~inner)};
}

// The same through imagesOf, cleanSurface and makeRelief.
cv::Mat reliefHeights(const cv::Mat& levels, const cv::Mat& mask) {
  SourceInfo info;
  info.width_px = info.height_px = levels.cols;
  info.depth_kind = DepthKind::kHeight;
  RgbdFrame frame;
  frame.color = cv::Mat::zeros(levels.size(), CV_8UC3);
  frame.depth = levels;
  const FrameImages view = makeFrameImages(frame, info);
  DepthNoise noise = measureNoise(view.depth);
  noise.eight_bit = true;
  const Surface surface = cleanSurface(view.depth, mask, noise, Method::kHapticast);
  const auto relief = makeRelief(surface, kHeightRange, kWorkspace, Method::kHapticast);
  cv::Mat out = cv::Mat::zeros(levels.size(), CV_32FC1);
  const cv::Rect box(relief->rect.u, relief->rect.v, relief->rect.width, relief->rect.height);
  cv::Mat(box.size(), CV_32FC1, const_cast<float*>(relief->height_mm.data())).copyTo(out(box));
  return out;
}

// Measured, mm inside / in the 5 px rim, radius 60 and 120 px, still and moving alike to 5 %: as it
// is .034 / .034, the fit alone .008 / .12-.18, the fit kept within half a step .008 / .05; with a
// rim rejected for being steep .011 / .8-1.2.
TEST(Enhance, EightBitDepthHasNoTerraces) {
  for (const double radius_px : {60.0, 120.0}) {
    for (int step = 0; step < 6; ++step) {
      const cv::Mat truth = ballHeights(radius_px, 140 + 0.37 * step, 140 + 0.21 * step);
      const cv::Mat mask = truth > 0;
      const cv::Mat levels = buildLevels(truth);
      const Rms as_it_is = rmsError(levels * (30.0 / 255.0), truth, mask);
      const Rms fit = rmsError(fitQuadratic(levels * (30.0 / 255.0), mask, 2.6), truth, mask);
      const Rms ours = rmsError(reliefHeights(levels, mask), truth, mask);
      EXPECT_LT(ours.inside, 0.012);
      EXPECT_LT(ours.inside, 0.35 * as_it_is.inside);
      EXPECT_LT(ours.rim, 0.065);
      EXPECT_LT(ours.rim, 0.5 * fit.rim);
    }
  }
}

// Error of the slope along u, rms, 5 px and more from the rim.
double slopeError(const cv::Mat& heights, const cv::Mat& truth, const cv::Mat& mask) {
  const cv::Mat along = (cv::Mat_<float>(1, 3) << -2.0F, 0.0F, 2.0F);  // of pixels of 0.25 mm
  cv::Mat error;
  cv::filter2D(heights - truth, error, CV_32F, along);
  const cv::Mat inner = erodeBy(mask, 5);
  return cv::norm(error, cv::NORM_L2, inner) / std::sqrt(cv::countNonZero(inner));
}

// The narrow fit alone, within half a step of the levels.
cv::Mat narrowFit(const cv::Mat& levels, const cv::Mat& mask) {
  const cv::Mat rounded = levels * (30.0 / 255.0);
  const double half_mm = 15.0 / 255.0;
  cv::Mat out;
  cv::max(fitQuadratic(rounded, mask, 2.6), rounded - half_mm, out);
  cv::min(out, rounded + half_mm, out);
  return out;
}

// Measured: 0.0006-0.0059; of the narrow fit 0.0025-0.035: its window shows one terrace only.
TEST(Enhance, EightBitDepthOfAGentleSlopeHasNoTerraces) {
  const cv::Mat mask = discMask(280, 100);
  for (const double slope : {0.02, 0.05, 0.1}) {
    const cv::Mat truth = painted(
        280, [&](int u, int v) { return 12.0 + 0.25 * (slope * (u - 140) + 0.4 * slope * v); });
    const cv::Mat levels = buildLevels(truth);
    const double narrow = slopeError(narrowFit(levels, mask), truth, mask);
    const double ours = slopeError(reliefHeights(levels, mask), truth, mask);
    EXPECT_LT(ours, 0.01) << slope;
    EXPECT_LT(ours, 0.35 * narrow) << slope;
  }
}

// Waves that are too short for a wider window are hardly worse off with one: measured, heights and
// slopes, 16 px 1.0 / 1.0 of the narrow fit's error, 24 px 1.0 / 1.08, 32 px 1.02 / .92, 60 px .5 /
// .35.
TEST(Enhance, EightBitDepthKeepsItsWaves) {
  const cv::Mat mask = discMask(280, 100);
  for (const double length_px : {16.0, 24.0, 32.0, 60.0}) {
    const cv::Mat truth = painted(280, [&](int u, int v) {
      return 12.0 + 0.5 * std::sin(2.0 * M_PI * u / length_px) + 0.01 * v;
    });
    const cv::Mat levels = buildLevels(truth);
    const cv::Mat narrow = narrowFit(levels, mask);
    const cv::Mat ours = reliefHeights(levels, mask);
    EXPECT_LT(rmsError(ours, truth, mask).inside, 1.1 * rmsError(narrow, truth, mask).inside);
    EXPECT_LT(slopeError(ours, truth, mask), 1.1 * slopeError(narrow, truth, mask));
  }
}

TEST(Enhance, ThesisRoundsTheRimOff) {
  const cv::Mat mask = discMask(120, 45);
  const auto object = [](int, int) { return 700.0; };
  const Surface surface = cleanSurface(painted(120, object), mask, kNoise, Method::kThesis);
  const auto relief = makeRelief(surface, kRange, kWorkspace, Method::kThesis);
  EXPECT_LT(worstError(*relief, mask, object, 9), 1e-3);
  EXPECT_GT(worstError(*relief, mask, object, 0), 5.0);
}

TEST(Enhance, HeightsStayInTheWorkspace) {
  const cv::Mat mask = discMask(120, 45);
  const cv::Mat depth = painted(120, [](int u, int) { return 300.0 + 8 * u; });
  const Surface surface = cleanSurface(depth, mask, kNoise, Method::kHapticast);
  const auto relief = makeRelief(surface, kRange, kWorkspace, Method::kHapticast);
  for (const float height : relief->height_mm) {
    EXPECT_GE(height, 0.0F);
    EXPECT_LE(height, 30.0F);
  }
}

TEST(Enhance, AnObjectWithoutAnyDepthIsFlat) {
  const cv::Mat mask = discMask(120, 45);
  const cv::Mat depth = cv::Mat::zeros(120, 120, CV_32FC1);
  const Surface surface = cleanSurface(depth, mask, kNoise, Method::kHapticast);
  const auto relief = makeRelief(surface, kRange, kWorkspace, Method::kHapticast);
  for (const float height : relief->height_mm) {
    EXPECT_EQ(height, 0.0F);
  }
}

TEST(Enhance, RangeHoldsTheObjectAndIsNeverTooNarrow) {
  const cv::Mat mask = discMask(120, 45);
  RangeFinder wide;
  EXPECT_FALSE(wide.range(0.05).has_value());
  wide.add(1,
           cleanSurface(painted(120, [](int u, int) { return 500.0 + 5 * u; }), mask, kNoise,
                        Method::kHapticast),
           kNoise);
  const DepthRange range = wide.range(0.05)->range;
  EXPECT_LT(range.near_mm, 590);
  EXPECT_GT(range.far_mm, 1000);
  RangeFinder flat;
  flat.add(
      1,
      cleanSurface(painted(120, [](int, int) { return 700.0; }), mask, kNoise, Method::kHapticast),
      kNoise);
  EXPECT_NEAR(flat.range(0.05)->range.far_mm - flat.range(0.05)->range.near_mm, 60, 1e-9);
  RangeFinder noisy;
  noisy.add(
      1,
      cleanSurface(painted(120, [](int, int) { return 700.0; }), mask, kNoise, Method::kHapticast),
      {{4.0}, 0});
  EXPECT_NEAR(noisy.range(0.05)->range.far_mm - noisy.range(0.05)->range.near_mm, 240, 1e-9);
}

// Wide windows are worked out in fewer pixels: on a dome of 15 mm radius, 12 px per mm, that must
// not be felt.
TEST(Enhance, AWideFitIsTheSameInFewerPixels) {
  constexpr double kPxPerMm = 12.0;
  const cv::Size size(301, 299);
  cv::Mat height(size, CV_32FC1, cv::Scalar(0));
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double r_mm = std::hypot(u - 150.2, v - 148.7) / kPxPerMm;
      if (r_mm > 11.5) continue;
      mask.at<uchar>(v, u) = 255;
      height.at<float>(v, u) = static_cast<float>(std::sqrt(15.0 * 15.0 - r_mm * r_mm));
    }
  }
  const cv::Mat fitted = fitQuadratic(height, mask, 0.65 * kPxPerMm);
  cv::Mat off;
  cv::absdiff(fitted, height, off);
  double worst_mm = 0;
  cv::minMaxLoc(off, nullptr, &worst_mm, nullptr, nullptr, mask);
  EXPECT_LT(worst_mm, 0.05);
  EXPECT_LT(cv::norm(fitted, height, cv::NORM_L2, mask) / std::sqrt(cv::countNonZero(mask)), 0.01);
}

}  // namespace
}  // namespace hapticast::server
