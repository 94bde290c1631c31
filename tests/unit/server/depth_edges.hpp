// SPDX-License-Identifier: MIT
// Drawn scenes with colour and depth at full size, and the distance of the depth edges of a scaled
// picture from the true ones.
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace hapticast::server {

enum class EdgeShape { kDisc, kBar, kHand };

/// A textured shape before a textured background.
struct EdgeScene {
  cv::Mat color;  ///< CV_8UC3; pixels on the outline have a mixed colour
  cv::Mat depth;  ///< CV_32FC1, mm: the shape about 700, the background about 1300
  cv::Mat near;   ///< CV_8UC1, 255 on the shape: the pixels of which it covers half
};

/// Returns a texture with a mean of `level` and a deviation of about 12 levels.
inline cv::Mat drawTexture(cv::Size size, const cv::Scalar& level, cv::RNG& random) {
  cv::Mat coarse(size, CV_32FC3);
  random.fill(coarse, cv::RNG::NORMAL, 0.0, 1.0);
  cv::GaussianBlur(coarse, coarse, {}, 3.0);
  cv::Mat fine(size, CV_32FC3);
  random.fill(fine, cv::RNG::NORMAL, 0.0, 4.0);
  cv::Mat texture = coarse * 110.0 + fine;
  return texture + level;
}

/// Draws `shape` in white on `mask`, somewhere and at some angle.
inline void drawShape(EdgeShape shape, cv::Mat& mask, cv::RNG& random) {
  const double unit = 0.01 * mask.rows;
  const cv::Point2d middle(mask.cols * random.uniform(0.4, 0.6),
                           mask.rows * random.uniform(0.4, 0.6));
  const double turn = random.uniform(0.0, CV_PI);
  const auto drawArm = [&](double angle, double from, double to, double wide) {
    const cv::Point2d along(std::cos(angle) * unit, std::sin(angle) * unit);
    cv::line(mask, middle + along * from, middle + along * to, 255,
             std::max(1, static_cast<int>(wide * unit)), cv::LINE_8);
  };
  if (shape == EdgeShape::kDisc) {
    cv::circle(mask, middle, static_cast<int>(random.uniform(12.0, 30.0) * unit), 255, cv::FILLED);
  } else if (shape == EdgeShape::kBar) {
    drawArm(turn, -40.0, 40.0, random.uniform(4.0, 12.0));
  } else {
    cv::ellipse(mask, middle, cv::Size2d(13.0 * unit, 11.0 * unit), turn * 180.0 / CV_PI, 0.0,
                360.0, 255, cv::FILLED);
    for (int finger = 0; finger < 5; ++finger)
      drawArm(turn + 0.35 * (finger - 2), 0.0, 30.0 - 2.0 * std::abs(finger - 2), 4.5);
    drawArm(turn + CV_PI, 0.0, 60.0, 12.0);
  }
}

/// Draws a scene. `contrast`: distance of the mean colours of shape and background, levels.
inline EdgeScene drawEdgeScene(EdgeShape shape, cv::Size size, int seed, double contrast) {
  constexpr int kFiner = 4;
  cv::RNG random(static_cast<std::uint64_t>(seed) * 7919 + 17);
  cv::Mat mask = cv::Mat::zeros(size * kFiner, CV_8UC1);
  drawShape(shape, mask, random);
  cv::Mat share;
  cv::resize(mask, share, size, 0.0, 0.0, cv::INTER_AREA);
  EdgeScene scene;
  scene.near = share >= 128;
  share.convertTo(share, CV_32F, 1.0 / 255.0);
  cv::merge(std::vector<cv::Mat>(3, share), share);
  cv::Vec3d apart(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  apart *= 0.5 * contrast / cv::norm(apart);
  const cv::Scalar middle = cv::Scalar::all(128.0);
  const cv::Scalar step(apart[0], apart[1], apart[2]);
  const cv::Mat front = drawTexture(size, middle + step, random);
  const cv::Mat back = drawTexture(size, middle - step, random);
  cv::Mat color = front.mul(share) + back.mul(cv::Scalar::all(1.0) - share);
  color.convertTo(scene.color, CV_8UC3);
  cv::Mat noise(size, CV_32FC1);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
  scene.depth = cv::Mat(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double slope = 60.0 * u / size.width + 40.0 * v / size.height;
      const bool near = scene.near.at<unsigned char>(v, u) != 0;
      scene.depth.at<float>(v, u) =
          static_cast<float>((near ? 700.0 : 1300.0) + slope) + noise.at<float>(v, u);
    }
  }
  return scene;
}

/// Distances of edges, px: mean and 95 % quantile.
struct EdgeError {
  double mean_px = 0.0;
  double q95_px = 0.0;
};

/// Returns where neighbouring pixels of `near` differ: non-zero on a grid of twice its size.
inline cv::Mat findBoundary(const cv::Mat& near) {
  cv::Mat boundary = cv::Mat::zeros(near.rows * 2, near.cols * 2, CV_8UC1);
  for (int v = 0; v < near.rows; ++v) {
    for (int u = 0; u < near.cols; ++u) {
      const unsigned char here = near.at<unsigned char>(v, u);
      if (u + 1 < near.cols && near.at<unsigned char>(v, u + 1) != here)
        boundary.at<unsigned char>(2 * v, 2 * u + 1) = 255;
      if (v + 1 < near.rows && near.at<unsigned char>(v + 1, u) != here)
        boundary.at<unsigned char>(2 * v + 1, 2 * u) = 255;
    }
  }
  return boundary;
}

/// Returns how far the boundaries of two masks are apart, from each point of either one.
inline EdgeError compareBoundaries(const cv::Mat& a, const cv::Mat& b) {
  std::vector<float> distances;
  const auto add = [&distances](const cv::Mat& from, const cv::Mat& to) {
    cv::Mat distance;
    cv::distanceTransform(to == 0, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    for (int v = 0; v < from.rows; ++v) {
      for (int u = 0; u < from.cols; ++u) {
        if (from.at<unsigned char>(v, u) != 0) distances.push_back(0.5F * distance.at<float>(v, u));
      }
    }
  };
  const cv::Mat first = findBoundary(a);
  const cv::Mat second = findBoundary(b);
  add(first, second);
  add(second, first);
  std::sort(distances.begin(), distances.end());
  EdgeError error;
  for (const float distance : distances) error.mean_px += double(distance);
  error.mean_px /= static_cast<double>(std::max<std::size_t>(distances.size(), 1));
  if (!distances.empty()) error.q95_px = double(distances[distances.size() * 95 / 100]);
  return error;
}

/// Returns depth at `size`: the upper left pixel of each cell, or the mean of the cell.
inline cv::Mat sampleDepth(const cv::Mat& depth, cv::Size size, bool mean) {
  cv::Mat sampled;
  if (mean) {
    cv::resize(depth, sampled, size, 0.0, 0.0, cv::INTER_AREA);
    return sampled;
  }
  sampled.create(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u)
      sampled.at<float>(v, u) =
          depth.at<float>(v * depth.rows / size.height, u * depth.cols / size.width);
  }
  return sampled;
}

}  // namespace hapticast::server
