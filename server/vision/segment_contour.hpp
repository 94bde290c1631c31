// SPDX-License-Identifier: MIT
// Decides anew, from colour, depth, planes and the last mask, the band of pixels around an object's
// contour; what lies deeper inside or further out stays (segmentation notes, section 3.3).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment_color.hpp"
#include "server/vision/segment_scene.hpp"
#include "server/vision/view.hpp"

namespace hapticast::server {

inline constexpr int kBand_px = 7;

/// What is remembered of an object between frames.
struct ContourMemory {
  ColorHistogram first;       ///< of the first mask; stays for good
  ColorHistogram now;         ///< follows slowly
  ColorHistogram background;  ///< of the ring around the object
  cv::Mat evidence;           ///< CV_32FC1 over `box`: the last decision, > 0 object
  cv::Rect box;
};

struct ContourResult {
  cv::Mat mask;               ///< CV_8UC1, 0 / 255, size of the picture
  double inside_color = 0.0;  ///< mean colour evidence inside; below 0 it is not the object
};

/// `carried`: the last mask moved to this frame. `memory.evidence` must be carried to it too (or
/// empty); it is replaced by this frame's. The histograms are not touched; see learn().
ContourResult decideContour(const View& view, const cv::Mat& carried, const DepthNoise& noise,
                            const std::vector<Plane>& planes, ContourMemory& memory);

/// Takes the colours of `mask` and of the ring around it into the memory.
void learn(const View& view, const cv::Mat& mask, ContourMemory& memory);

}  // namespace hapticast::server
