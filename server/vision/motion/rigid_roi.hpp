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

/// Values at one pixel; gradients per px of the level.
struct Texel {
  float gray, gray_u, gray_v;
  float depth, depth_u, depth_v;  ///< mm; depth 0: not measured
};

/// Region of a picture on one level. Its pixel (0, 0) covers factor x factor pixels from `origin`.
struct RigidRoi {
  cv::Point origin;
  int factor = 1;
  int columns = 0, rows = 0;
  std::vector<Texel> texels;  ///< row by row

  /// Converts a position in the picture (px, centres at +0.5) to a position on this level (centres
  /// at whole numbers).
  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector2d& at_px) const {
    return {(at_px.x() - origin.x) / factor - 0.5, (at_px.y() - origin.y) / factor - 0.5};
  }
  /// Interpolates bilinearly. Returns false outside the region. Depth is 0 if one of the four
  /// neighbours has none.
  bool sample(const Eigen::Vector2d& at, Texel& out) const;
};

/// Returns the ROI of `area`, clipped to whole level pixels. Depths more than 80 mm beyond `depths`
/// are not the object's and count as not measured.
RigidRoi cropRoi(const FrameImages& images, const cv::Rect& area, int factor,
                 const DepthRange& depths);

/// Returns `image` at 1/factor of its size each way. Requires a size that is a multiple of
/// `factor`.
cv::Mat shrunk(const cv::Mat& image, int factor);
/// Returns the depth, smoothed over the pixels of `known` (CV_8UC1, 0/255) and reduced by `factor`.
/// 0 where too few pixels are in `known`.
cv::Mat smoothedDepth(const cv::Mat& depth, const cv::Mat& known, int factor);
/// Returns `gray` as CV_32FC1, reduced by `factor` and smoothed.
cv::Mat smoothedGray(const cv::Mat& gray, int factor);

}  // namespace hapticast::server
