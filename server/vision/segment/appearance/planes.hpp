// SPDX-License-Identifier: MIT
// The planes that things stand on, found and followed in working depth: what lies on one or behind
// it is no object's. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

/// A plane in inverse depth, 1/z = a u + b v + c: exact for planes, without intrinsics.
struct Plane {
  double a = 0.0, b = 0.0, c = 0.0;
  double tolerance_mm = 2.0;  ///< 3 MAD + 2 mm, before the part that grows with slope
  double widest_mm = 2.0;     ///< what the depth's noise allows it to be
  double share = 0.0;         ///< of the picture that lies on it
  bool support = false;       ///< objects stand on it: what lies behind is not theirs either

  [[nodiscard]] double inverse(double u, double v) const { return a * u + b * v + c; }
  /// How far `depth_mm` at (u, v) lies behind the plane, in tolerances: within +-1 is on it.
  [[nodiscard]] double behind(double u, double v, double depth_mm) const;
};

/// Up to three planes with at least 6 % of the picture each, by RANSAC and five reweighted fits.
std::vector<Plane> findPlanes(const cv::Mat& depth, const DepthNoise& noise);
/// Moves the planes to this frame; false when one of them holds less than 60 % of what it held.
bool refitPlanes(const cv::Mat& depth, std::vector<Plane>& planes);
/// Over `box`: 255 on a plane or behind a support.
cv::Mat onPlanes(const cv::Mat& depth, const cv::Rect& box, const std::vector<Plane>& planes);
/// Marks as support what holds more than 8 % of the 40 px ring around `mask`.
void findSupports(const cv::Mat& depth, const cv::Mat& mask, std::vector<Plane>& planes);

}  // namespace hapticast::server
