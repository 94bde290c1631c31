// SPDX-License-Identifier: MIT
// What the rigid alignment reads of a picture: grey, depth and their slopes over a part of it, on
// one level of a pyramid. Thread: any; values.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "server/source/camera_model.hpp"
#include "server/vision/base/frame_images.hpp"

namespace hapticast::server {

/// At one place; slopes per px of the level.
struct Texel {
  float gray, gray_u, gray_v;
  float depth, depth_u, depth_v;  ///< mm; depth 0: not known
};

/// Part of a picture on one level: its pixel (0, 0) covers factor x factor pixels from `origin`.
struct RigidRoi {
  cv::Point origin;
  int factor = 1;
  int columns = 0, rows = 0;
  std::vector<Texel> texels;

  /// Position on this level (pixel centres at whole numbers) of a place in the picture (centres at
  /// +0.5).
  [[nodiscard]] Eigen::Vector2d place(const Eigen::Vector2d& at_px) const {
    return {(at_px.x() - origin.x) / factor - 0.5, (at_px.y() - origin.y) / factor - 0.5};
  }
  /// Bilinear; false outside. Depth is 0 where one of the four neighbours has none.
  bool sample(const Eigen::Vector2d& at, Texel& out) const;
};

/// `area` is cut to whole level pixels. Depths further than 80 mm from `depths` are not the
/// object's and count as not known.
RigidRoi cropRoi(const FrameImages& images, const cv::Rect& area, int factor,
                 const DepthRange& depths);

/// `image` in 1/factor of its size each way; the size a multiple of `factor`.
cv::Mat shrunk(const cv::Mat& image, int factor);
/// Depth where `known` (0 / 255), smoothed over what is known; 0 where too little is.
cv::Mat smoothedDepth(const cv::Mat& depth, const cv::Mat& known, int factor);
cv::Mat smoothedGray(const cv::Mat& gray, int factor);

}  // namespace hapticast::server
