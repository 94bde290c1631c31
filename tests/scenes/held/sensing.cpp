// SPDX-License-Identifier: MIT
#include "tests/scenes/held/sensing.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/scenes/held/render.hpp"
#include "tests/scenes/sensor.hpp"

namespace hapticast::evaluate::held {

namespace {

// A structured-light camera as they are sold: 75 mm from projector to camera, disparity in eighths
// of a px.
constexpr double kBaseline_mm = 75.0;
constexpr double kDisparityStep_px = 0.125;
constexpr double kStructuredNoise = 1.1e-6;  // 1/mm: 0.7 mm at 0.8 m
constexpr double kFlightNoise_mm = 1.4;
constexpr double kDark = 26.0;  // levels: darker than this reflects too little

// Noise so wide that a few numbers define it.
cv::Mat wideNoise(cv::RNG& random, const cv::Size& size, int cells) {
  cv::Mat noise(cells * 3 / 4, cells, CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  cv::resize(noise, noise, size, 0, 0, cv::INTER_CUBIC);
  return noise;
}

cv::Mat brightnessOf(const cv::Mat& color) {
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::GaussianBlur(gray, gray, {}, 1.5);
  return gray;
}

// Shadow of the projector, to the right of the camera: a near surface hides the one that is left
// of it. Seen from the projector, places of a row have to come in the same order.
void castShadows(const cv::Mat& exact, double focal_px, cv::Mat& depth) {
  for (int v = 0; v < exact.rows; ++v) {
    const auto* z = exact.ptr<float>(v);
    auto* out = depth.ptr<float>(v);
    double leftmost = 1e9;
    for (int u = exact.cols - 1; u >= 0; --u) {
      const double seen = u - focal_px * kBaseline_mm / double(z[u]);
      if (seen > leftmost + 0.5) out[u] = 0.0F;
      leftmost = std::min(leftmost, seen);
    }
  }
}

cv::Mat structured(const Exact& exact, double focal_px, cv::RNG& random) {
  cv::Mat depth = exact.depth.clone();
  const cv::Size size = depth.size();
  const cv::Mat noise = makeNoise(random, size, 1.3);
  const cv::Mat blobs = makeNoise(random, size, 2.5);
  const cv::Mat off_u = makeNoise(random, size, 5.0);
  const cv::Mat off_v = makeNoise(random, size, 5.0);
  const cv::Mat gray = brightnessOf(exact.color);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      // Correlation of patches: a rim is found a little beside where it is.
      const int from_u = std::clamp(u + cvRound(1.1 * off_u.at<float>(v, u)), 0, size.width - 1);
      const int from_v = std::clamp(v + cvRound(1.1 * off_v.at<float>(v, u)), 0, size.height - 1);
      const float here = exact.depth.at<float>(v, u);
      const float there = exact.depth.at<float>(from_v, from_u);
      const double z = double(std::abs(there - here) > 15.0F ? there : here);
      const double noisy = z + kStructuredNoise * z * z * double(noise.at<float>(v, u));
      const double disparity = focal_px * kBaseline_mm / noisy;
      const double stepped = kDisparityStep_px * std::round(disparity / kDisparityStep_px);
      const int blind = exact.blind.at<uchar>(v, u);
      const float blob = blobs.at<float>(v, u);
      const bool lost = ((blind & kSurface) != 0 && blob > -1.2F) || (blind & kGlare) != 0 ||
                        ((blind & kGrazing) != 0 && blob > -0.3F) || blob > 2.7F ||
                        (double(gray.at<uchar>(v, u)) < kDark && blob > 0.2F) || z > 6000.0;
      depth.at<float>(v, u) =
          lost ? 0.0F : static_cast<float>(focal_px * kBaseline_mm / std::max(1.0, stepped));
    }
  }
  castShadows(exact.depth, focal_px, depth);
  // What is left of an island is no measurement.
  cv::Mat known;
  cv::medianBlur(depth > 0, known, 3);
  depth.setTo(0, known == 0);
  return depth;
}

cv::Mat flight(const Exact& exact, std::uint64_t seed, cv::RNG& random) {
  const cv::Size size = exact.depth.size();
  // A pixel's light comes from a little around it: at rims a mixture of near and far.
  cv::Mat mixed;
  cv::GaussianBlur(cv::min(exact.depth, 6000.0), mixed, {}, 0.8);
  cv::RNG fixed_random(seed * 31 + 7);
  const cv::Mat fixed = makeNoise(fixed_random, size, 0.0);
  const cv::Mat noise = makeNoise(random, size, 0.0);
  const cv::Mat blobs = makeNoise(random, size, 1.5);
  const cv::Mat gray = brightnessOf(exact.color);
  cv::Mat depth(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double light = std::max(12.0, double(gray.at<uchar>(v, u)));
      const double z = double(mixed.at<float>(v, u));
      const double sigma = kFlightNoise_mm * std::sqrt(90.0 / light) * std::max(0.6, z / 900.0);
      const double rim = std::abs(z - double(exact.depth.at<float>(v, u)));
      const int blind = exact.blind.at<uchar>(v, u);
      const float blob = blobs.at<float>(v, u);
      const bool lost = ((blind & kGlare) != 0 && blob > -0.5F) || z > 5000.0 ||
                        ((blind & kSurface) != 0 && blob > 1.0F) || (rim > 25.0 && blob > 0.3F) ||
                        (light < 14.0 && blob > 0.0F);
      depth.at<float>(v, u) = lost ? 0.0F
                                   : static_cast<float>(z + sigma * double(noise.at<float>(v, u)) +
                                                        0.7 * double(fixed.at<float>(v, u)));
    }
  }
  return depth;
}

cv::Mat room8(const Sensing& sensing, const Exact& exact, cv::RNG& random) {
  const cv::Size size = exact.depth.size();
  cv::Mat soft;
  cv::GaussianBlur(cv::min(exact.depth, sensing.far_mm), soft, {}, 0.9);
  const cv::Mat noisy = soft + 2.0 * makeNoise(random, size, 1.2);
  cv::Mat heights;
  cv::Mat((sensing.far_mm - noisy) * (255.0 / (sensing.far_mm - sensing.near_mm)))
      .convertTo(heights, CV_8U);
  cv::Mat out;
  compressJpeg(heights, 78).convertTo(out, CV_32F);
  return out;
}

// An estimator's inverse depth: smooth errors that belong to the scene, rims that it rounds, a
// scale and shift that it finds anew in every frame.
cv::Mat estimate(const Sensing& sensing, const Exact& exact, cv::RNG& random) {
  const cv::Size size = exact.depth.size();
  cv::Mat inverse = 1.0 / cv::min(exact.depth, 2.0 * sensing.far_mm);
  cv::bilateralFilter(cv::Mat(inverse * 1e5), inverse, 9, 12.0, 3.0);
  inverse *= 1e-5;
  cv::GaussianBlur(inverse, inverse, {}, 1.2);
  cv::RNG fixed_random(sensing.seed * 17 + 3);
  const cv::Mat bent = wideNoise(fixed_random, size, 6);
  cv::Mat drifting = wideNoise(random, size, 8);
  const double nearest = 1.0 / sensing.near_mm;
  const double farthest = 1.0 / (2.0 * sensing.far_mm);
  const double scale = 1.0 + sensing.flicker * random.gaussian(1.0);
  const double shift = 0.5 * sensing.flicker * (nearest - farthest) * random.gaussian(1.0);
  inverse = inverse.mul(cv::Mat(1.0 + 0.01 * bent + 0.0015 * drifting)) * scale + shift;
  if (sensing.kind == DepthSense::kEstimate16) return 1.0 / cv::max(inverse, 0.5 * farthest);
  cv::Mat levels;
  cv::Mat((inverse - farthest) * (255.0 / (nearest - farthest))).convertTo(levels, CV_8U);
  levels.convertTo(levels, CV_32F);
  return levels;
}

}  // namespace

double exposureAt(const Sensing& sensing, double share_of_clip) {
  // The camera's automatic control: it overshoots, then settles.
  const double t = share_of_clip;
  return 1.0 + sensing.exposure_swing * std::sin(9.0 * t) * std::exp(-1.2 * t);
}

Color gainAt(const Sensing& sensing, double share_of_clip) {
  const auto gain = static_cast<float>(exposureAt(sensing, share_of_clip));
  const double balanced = std::clamp((share_of_clip - 0.45) / 0.1, 0.0, 1.0);
  const auto cast = static_cast<float>(sensing.green_cast * (1.0 - balanced));
  return gain * Color(1.0F - 0.6F * cast, 1.0F + cast, 1.0F - cast);
}

void sense(const Sensing& sensing, const Exact& exact, double focal_px, server::RgbdFrame& frame) {
  cv::RNG random(sensing.seed * 7919 + frame.index + 1);
  frame.color = exact.color.clone();
  addColorNoise(frame.color, sensing.color_noise, random);
  if (sensing.jpeg_quality > 0) frame.color = compressJpeg(frame.color, sensing.jpeg_quality);
  cv::Mat depth;
  switch (sensing.kind) {
    case DepthSense::kExact:
      depth = exact.depth.clone();
      break;
    case DepthSense::kStructured:
      depth = structured(exact, focal_px, random);
      break;
    case DepthSense::kFlight:
      depth = flight(exact, sensing.seed, random);
      break;
    case DepthSense::kRoom8:
      depth = room8(sensing, exact, random);
      break;
    case DepthSense::kEstimate8:
    case DepthSense::kEstimate16:
      depth = estimate(sensing, exact, random);
      break;
  }
  frame.depth = shiftDepth(depth, sensing.beside_px, sensing.below_px);
}

}  // namespace hapticast::evaluate::held
