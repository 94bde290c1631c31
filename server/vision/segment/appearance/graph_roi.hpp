// SPDX-License-Identifier: MIT
// Region of interest (ROI) for graph cuts: a part of the picture, reduced so that each of its
// pixels can be a node of a graph. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/frame_images.hpp"
#include "server/vision/segment/appearance/planes.hpp"
#include "server/vision/segment/appearance/skin.hpp"

namespace hapticast::server {

/// A frame, and the model of the scene behind its objects.
struct FrameContext {
  const FrameImages& images;
  const std::vector<Plane>& planes;
  const DepthNoise& noise;
  const SkinColors& skin;
};

/// Images of the region, all of size().
struct GraphRoi {
  cv::Rect box;         ///< of the picture
  double shrink = 1.0;  ///< px of the ROI for each px of the picture, at most 1
  cv::Mat color;        ///< CV_8UC3, BGR
  cv::Mat lab;          ///< CV_32FC3, L 0..100
  cv::Mat depth;        ///< CV_32FC1, working depth, mm, 0: not measured
  cv::Mat plane;        ///< CV_8UC1, 255 on a plane or behind a support
  cv::Mat skin;         ///< CV_8UC1, 255: skin

  /// Returns the ROI of `box` (px of the picture) with at most `most_px` pixels.
  static GraphRoi around(const FrameContext& scene, const cv::Rect& box, double most_px);
  [[nodiscard]] cv::Size size() const { return lab.size(); }
  /// Converts a mask (0/255) of the whole picture to this ROI, and a mask of this ROI to the whole
  /// picture.
  [[nodiscard]] cv::Mat shrunk(const cv::Mat& mask) const;
  [[nodiscard]] cv::Mat inPicture(const cv::Mat& mask, const cv::Size& picture) const;
  /// Returns the largest depth step between neighbours of the ROI on one surface, mm.
  [[nodiscard]] float step_mm(const DepthNoise& scene, float depth_mm) const {
    return static_cast<float>((0.5 + 0.5 / shrink) * scene.step_mm(double(depth_mm)));
  }
  /// Converts a position in the picture to the ROI, px.
  [[nodiscard]] cv::Point toRoi(const cv::Point& at) const;
};

/// Returns the px of the picture for one mm at `depth_mm`, for a camera with a usual field of view.
double pixelsPerMm(double depth_mm, const cv::Size& picture);

}  // namespace hapticast::server
