// SPDX-License-Identifier: MIT
// A part of the picture, shrunk so far that every pixel of it can be a node of a graph. Thread: the
// one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/base/depth_noise.hpp"
#include "server/vision/base/frame_images.hpp"
#include "server/vision/segment/appearance/planes.hpp"
#include "server/vision/segment/appearance/skin.hpp"

namespace hapticast::server {

/// A frame with what is known of the scene behind its objects.
struct FrameContext {
  const FrameImages& images;
  const std::vector<Plane>& planes;
  const DepthNoise& noise;
  const SkinColors& skin;
};

struct GraphRoi {
  cv::Rect box;         ///< of the picture
  double shrink = 1.0;  ///< px of the view per px of the picture, at most 1
  cv::Mat color;        ///< CV_8UC3, BGR
  cv::Mat lab;          ///< CV_32FC3, L 0..100
  cv::Mat depth;        ///< CV_32FC1, working depth, 0 = not measured
  cv::Mat plane;        ///< CV_8UC1, 255 on a plane or behind a support
  cv::Mat skin;         ///< CV_8UC1

  /// `box` of the scene's picture in at most `most_px` pixels.
  static GraphRoi around(const FrameContext& scene, const cv::Rect& box, double most_px);
  [[nodiscard]] cv::Size size() const { return lab.size(); }
  /// A mask (0 / 255) of the whole picture in this view, and one of this view in the whole picture.
  [[nodiscard]] cv::Mat shrunk(const cv::Mat& mask) const;
  [[nodiscard]] cv::Mat inPicture(const cv::Mat& mask, const cv::Size& picture) const;
  /// The largest step in depth between neighbours of the view on one surface.
  [[nodiscard]] float step_mm(const DepthNoise& scene, float depth_mm) const {
    return static_cast<float>((0.5 + 0.5 / shrink) * scene.step_mm(double(depth_mm)));
  }
  /// A place of the picture in the view.
  [[nodiscard]] cv::Point toRoi(const cv::Point& at) const;
};

/// px of the picture that a mm at `depth_mm` is wide, where the camera is not known.
double pixelsPerMm(double depth_mm, const cv::Size& picture);

}  // namespace hapticast::server
