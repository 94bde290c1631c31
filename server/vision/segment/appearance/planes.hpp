// SPDX-License-Identifier: MIT
// Plane detection in a depth image: finds tables, floors and walls, which belong to no object.
// RANSAC (Fischler and Bolles 1981) finds a plane, and reweighted least squares refine it. Thread:
// the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"

namespace hapticast::server {

/// A plane, as inverse depth over the picture: 1/z = a u + b v + c, with u and v in px. The model
/// is exact for any camera, so the camera's intrinsics are not needed.
struct Plane {
  double a = 0.0, b = 0.0, c = 0.0;
  /// Largest distance at which a depth counts as on the plane, mm. behind() adds a tolerance for
  /// the slope.
  double tolerance_mm = 2.0;
  double widest_mm = 2.0;  ///< limit of tolerance_mm, from the depth's noise
  double share = 0.0;      ///< share of the picture on the plane, 0..1
  bool support = false;    ///< the plane supports objects: no object extends behind it

  /// Returns the plane's inverse depth at (u, v), 1/mm.
  [[nodiscard]] double inverse(double u, double v) const { return a * u + b * v + c; }
  /// Returns how far the depth `depth_mm` at pixel (u, v) lies behind the plane, in units of the
  /// tolerance. Values from -1 to 1 are on the plane.
  [[nodiscard]] double behind(double u, double v, double depth_mm) const;
};

/// Returns up to three planes of `depth` (CV_32FC1, mm). A plane must cover at least 6 % of the
/// picture, or 2 % if it is a ground plane (table or floor).
std::vector<Plane> findPlanes(const cv::Mat& depth, const DepthNoise& noise);
/// Fits the planes again to the depth of this frame. Returns false if a plane lost more than 40 %
/// of its share of the picture.
bool refitPlanes(const cv::Mat& depth, std::vector<Plane>& planes);
/// Returns whether the depth `depth_mm` at pixel (u, v) is on one of the planes or behind a
/// supporting plane.
bool isOnPlanes(const std::vector<Plane>& planes, double u, double v, double depth_mm);
/// Returns a mask over `box` (px): 255 where the depth is on a plane or behind a supporting plane.
cv::Mat findOnPlanes(const cv::Mat& depth, const cv::Rect& box, const std::vector<Plane>& planes);
/// Marks the planes that support the object of `mask` (0/255). Such a plane covers more than 8 % of
/// a ring of 40 px around the mask.
void findSupports(const cv::Mat& depth, const cv::Mat& mask, std::vector<Plane>& planes);

/// Returns how many px of the picture one mm covers at `depth_mm`, for a camera with a usual field
/// of view.
double pixelsPerMm(double depth_mm, const cv::Size& picture);

}  // namespace hapticast::server
