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

/// The box around a mask with room for the band and the ring of background beyond it, and how far
/// each of its pixels lies inside the contour (CV_32FC1, px; outside below 0).
struct ContourRegion {
  cv::Rect box;  ///< empty: so is the mask
  cv::Mat distance;
};
ContourRegion contourRegion(const cv::Mat& mask);

struct ContourResult {
  cv::Mat mask;               ///< CV_8UC1, 0 / 255, size of the picture
  double inside_color = 0.0;  ///< mean colour evidence inside; below 0 it is not the object
};

/// `carried`: the last mask moved to this frame, and its region. `memory.evidence` must be carried
/// to it too (or empty); it is replaced by this frame's. The histograms are not touched; see
/// learn().
ContourResult decideContour(const View& view, const cv::Mat& carried, const ContourRegion& region,
                            const DepthNoise& noise, const std::vector<Plane>& planes,
                            ContourMemory& memory);

/// Takes the colours of `mask` and of the ring around it into the memory. `region`: of this mask or
/// of one whose contour is at most a band away.
void learn(const View& view, const cv::Mat& mask, const ContourRegion& region,
           ContourMemory& memory);

}  // namespace hapticast::server
