// SPDX-License-Identifier: MIT
// What a click may mean: masks by graph cuts of several reaches around it, and how much a mask
// looks like one thing. Done once per object. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/appearance/graph_roi.hpp"

namespace hapticast::server {

struct Click {
  cv::Point at;
  const std::vector<cv::Point>& not_points;
  const NegativeColors& avoided;
  cv::Mat component;  ///< what hangs together with it in depth, 0 / 255; empty: not known
};

/// Up to eight different masks (0 / 255, size of the picture) that the click is in.
std::vector<cv::Mat> candidateMasks(const FrameContext& scene, const Click& click);

/// How much `mask` looks like one thing that a person would mean, and nothing of its surroundings:
/// colours unlike the ring's, a contour on edges of colour and depth, solid, of a size that is
/// held in hands, measured, no skin. About 3 for a good one; of two masks the higher one is it.
double objectness(const FrameContext& scene, const cv::Mat& mask);

/// How wide a disc of the mask's area would be at its depth, mm.
double widthInSpace_mm(const FrameContext& scene, const cv::Mat& mask);

}  // namespace hapticast::server
