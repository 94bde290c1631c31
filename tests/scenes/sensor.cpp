// SPDX-License-Identifier: MIT
#include "tests/scenes/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace hapticast::evaluate {

cv::Mat makeNoise(cv::RNG& random, const cv::Size& size, double sigma_px) {
  cv::Mat noise(size, CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
  if (sigma_px <= 0) return noise;
  cv::GaussianBlur(noise, noise, {}, sigma_px);
  return noise * (2.0 * sigma_px * std::sqrt(CV_PI));  // back to rms 1
}

void addColorNoise(cv::Mat& color, double rms, cv::RNG& random) {
  cv::Mat noise(color.size(), CV_32FC3);
  random.fill(noise, cv::RNG::NORMAL, 0.0, rms);
  cv::add(color, noise, color, cv::noArray(), CV_8UC3);
}

cv::Mat compressJpeg(const cv::Mat& picture, int quality) {
  std::vector<uchar> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, picture.channels() == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR);
}

cv::Mat shiftDepth(const cv::Mat& depth, double right_px, double down_px) {
  if (right_px == 0.0 && down_px == 0.0) return depth;
  const cv::Matx23d shift{1, 0, right_px, 0, 1, down_px};
  cv::Mat out;
  cv::warpAffine(depth, out, shift, depth.size(), cv::INTER_NEAREST, cv::BORDER_REPLICATE);
  return out;
}

cv::Mat wobbleMask(const cv::Mat& mask, double rms_px, cv::RNG& random) {
  cv::Mat inside;
  cv::Mat outside;
  cv::distanceTransform(mask, inside, cv::DIST_L2, 5);
  cv::distanceTransform(mask == 0, outside, cv::DIST_L2, 5);
  const cv::Mat field = makeNoise(random, mask.size(), 12.0) * rms_px;
  return (inside - outside + field) > 0;
}

namespace {

void senseStereo(cv::Mat& depth, const cv::Mat& mask, SensorState& state, cv::RNG& random) {
  const cv::Size size = depth.size();
  const cv::Mat fresh = makeNoise(random, size, 2.0);
  const cv::Mat carried = makeNoise(random, size, 2.0);
  if (state.carried_noise.empty()) state.carried_noise = carried;
  // 70 % of the variance is new in every frame.
  const cv::Mat noise = std::sqrt(0.7) * fresh + std::sqrt(0.3) * state.carried_noise;
  state.carried_noise = noise;
  // The silhouette wobbles: depth is read from a place a little beside.
  const cv::Mat off_u = makeNoise(random, size, 6.0) * 1.2;
  const cv::Mat off_v = makeNoise(random, size, 6.0) * 1.2;
  const cv::Mat exact = depth.clone();
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const int from_u = std::clamp(u + cvRound(off_u.at<float>(v, u)), 0, size.width - 1);
      const int from_v = std::clamp(v + cvRound(off_v.at<float>(v, u)), 0, size.height - 1);
      const float there = exact.at<float>(from_v, from_u);
      const float here = exact.at<float>(v, u);
      const float z = std::abs(there - here) > 20.0F ? there : here;
      const float metres = z / 1000.0F;
      float& out = depth.at<float>(v, u);
      // A shadow of the nearer thing lies to the left of it.
      const float right = exact.at<float>(v, std::min(size.width - 1, u + 8));
      const bool shadow = z - right > 60.0F;
      out = shadow ? 0.0F : z + 1.5F * metres * metres * noise.at<float>(v, u);
    }
  }
  cv::Mat edge;
  cv::morphologyEx(mask, edge, cv::MORPH_GRADIENT, cv::Mat::ones(5, 5, CV_8UC1));
  const cv::Mat blobs = makeNoise(random, size, 3.0);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const bool flip = edge.at<uchar>(v, u) != 0 && random.uniform(0.0, 1.0) < 0.35;
      if (flip || blobs.at<float>(v, u) > 2.33F) depth.at<float>(v, u) = 0.0F;
    }
  }
}

void senseTimeOfFlight(cv::Mat& depth, const cv::Mat& exact, const SensorState& state,
                       cv::RNG& random) {
  cv::Mat noise(depth.size(), CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 1.6);
  depth += noise + 0.8 * state.fixed_noise;
  cv::Mat far;
  cv::dilate(exact, far, cv::Mat::ones(3, 3, CV_8UC1));
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const float jump = far.at<float>(v, u) - exact.at<float>(v, u);
      if (jump < 20.0F) continue;
      const double chance = random.uniform(0.0, 1.0);
      if (chance < 0.2) {
        depth.at<float>(v, u) = 0.0F;
      } else if (chance < 0.8) {
        depth.at<float>(v, u) += static_cast<float>(random.uniform(0.0, 1.0)) * jump;
      }
    }
  }
}

void senseEightBits(cv::Mat& depth, const server::DepthRange& range, double step) {
  const double span = range.far_mm - range.near_mm;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      float& z = depth.at<float>(v, u);
      const double level = 255.0 * (range.far_mm - double(z)) / span;
      z = static_cast<float>(std::clamp(step * std::round(level / step), 0.0, 255.0));
    }
  }
}

}  // namespace

cv::Mat senseDepth(const Sensor& sensor, const cv::Mat& exact_mm, const cv::Mat& mask,
                   const server::DepthRange& range, SensorState& state, cv::RNG& random) {
  cv::Mat depth = exact_mm.clone();
  if (sensor.depth_noise_mm > 0) {
    cv::Mat noise(depth.size(), CV_32FC1);
    random.fill(noise, cv::RNG::NORMAL, 0.0, sensor.depth_noise_mm);
    depth += noise;
  }
  switch (sensor.depth) {
    case Sensor::Depth::kExact:
      break;
    case Sensor::Depth::kStereo:
      senseStereo(depth, mask, state, random);
      break;
    case Sensor::Depth::kTimeOfFlight:
      senseTimeOfFlight(depth, exact_mm, state, random);
      break;
    case Sensor::Depth::kEightBit:
      senseEightBits(depth, range, sensor.levels_per_step);
      break;
  }
  return shiftDepth(depth, sensor.misalignment_px, 0.0);
}

}  // namespace hapticast::evaluate
