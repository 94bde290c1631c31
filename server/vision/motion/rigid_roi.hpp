// SPDX-License-Identifier: MIT
// Input of the rigid alignment: grey, depth and their gradients over a region of interest (ROI), on
// one level of an image pyramid. Thread: any.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "server/source/camera_model.hpp"
#include "server/vision/base/frame_pair.hpp"

namespace hapticast::server {

/// Grey and depth at one pixel of a level, with their gradients per px of the level.
struct Texel {
  float gray, gray_u, gray_v;
  float depth, depth_u, depth_v;  ///< mm; a depth of 0 was not measured
};

/// Region of a picture on one level of the pyramid. Each of its pixels covers factor x factor px of
/// the picture, and pixel (0, 0) begins at `origin`.
struct RigidRoi {
  cv::Point origin;
  int factor = 1;
  int columns = 0, rows = 0;
  std::vector<Texel> texels;  ///< row by row

  /// Returns where the position `at_px` of the picture (px, centres at +0.5) lies on this level (px
  /// of the level, centres at whole numbers).
  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector2d& at_px) const {
    return {(at_px.x() - origin.x) / factor - 0.5, (at_px.y() - origin.y) / factor - 0.5};
  }
  /// Writes the values at position `at` of this level into `out`, interpolated bilinearly. Returns
  /// false outside the region. The depth is 0 if one of the four neighbours has none.
  bool sample(const Eigen::Vector2d& at, Texel& out) const;
};

/// Returns the region `area` of the picture, reduced by `factor` and clipped to whole pixels of the
/// level. `depths`: range of the object's depths, mm. Depths more than 80 mm outside `depths` do
/// not belong to the object and count as not measured.
RigidRoi cropRoi(const FrameImages& images, const cv::Rect& area, int factor,
                 const DepthRange& depths);

/// Returns `image`, reduced by `factor` in both directions. Its sides must be multiples of
/// `factor`.
cv::Mat shrinkImage(const cv::Mat& image, int factor);
/// Returns `depth`, smoothed over the pixels of `known` (CV_8UC1, 0/255) and reduced by `factor`.
/// The result is 0 where too few pixels are in `known`.
cv::Mat smoothDepth(const cv::Mat& depth, const cv::Mat& known, int factor);
/// Returns `gray` as CV_32FC1, reduced by `factor` and smoothed.
cv::Mat smoothGray(const cv::Mat& gray, int factor);

}  // namespace hapticast::server
