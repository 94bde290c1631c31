// SPDX-License-Identifier: MIT
// Plane detection in working depth: RANSAC (Fischler and Bolles 1981) with reweighted least squares
// finds supporting planes and walls, which belong to no object. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

/// A plane in inverse depth, 1/z = a u + b v + c. The model is exact without camera intrinsics.
struct Plane {
  double a = 0.0, b = 0.0, c = 0.0;
  double tolerance_mm = 2.0;  ///< 3 MAD + 2 mm, without the part that grows with slope
  double widest_mm = 2.0;     ///< largest tolerance for the depth's noise
  double share = 0.0;         ///< share of the picture on the plane, 0..1
  bool support = false;       ///< objects lie on it: no object continues behind it

  /// Returns the plane's inverse depth at (u, v), 1/mm.
  [[nodiscard]] double inverse(double u, double v) const { return a * u + b * v + c; }
  /// Returns how far `depth_mm` at (u, v) lies behind the plane, in tolerances; within +-1: on the
  /// plane.
  [[nodiscard]] double behind(double u, double v, double depth_mm) const;
};

/// Finds up to three planes by RANSAC and five reweighted fits. A plane needs 6 % of the picture, a
/// ground plane 2 %. `depth`: CV_32FC1, mm.
std::vector<Plane> findPlanes(const cv::Mat& depth, const DepthNoise& noise);
/// Fits the planes to this frame. Returns false if one of them lost more than 40 % of its share.
bool refitPlanes(const cv::Mat& depth, std::vector<Plane>& planes);
/// Returns a mask over `box`: 255 on a plane or behind a support.
cv::Mat onPlanes(const cv::Mat& depth, const cv::Rect& box, const std::vector<Plane>& planes);
/// Marks a plane as support if it covers more than 8 % of the 40 px ring around `mask`.
void findSupports(const cv::Mat& depth, const cv::Mat& mask, std::vector<Plane>& planes);

}  // namespace hapticast::server
