// SPDX-License-Identifier: MIT
// Candidate masks of a click: iterated graph cuts of several reaches around it (GrabCut, Rother,
// Kolmogorov and Blake 2004), and an objectness score. Runs once for each object. Thread: the one
// that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

// Merges the visible parts of an object that an occluder (for example, fingers) splits into pieces.
// Thread: the one that runs Vision.

/// Returns the piece `main` with the pieces of `mask` (0/255, size of `view`) that connect to it
/// behind an occluder. Fills small holes. `px_per_mm`: px of the view.
/// A piece connects if no pixel between both lies behind both, and if it does not reach the view's
/// border.
cv::Mat mergeOccludedParts(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& main,
                           double px_per_mm);

/// A point of the author, and the negative samples.
struct Click {
  cv::Point at;
  const std::vector<cv::Point>& not_points;
  const NegativeColors& avoided;
  cv::Mat component;  ///< its connected component in depth, 0/255; empty: unknown
};

/// Returns up to eight different masks (CV_8UC1, 0/255, image size) that contain the click.
std::vector<cv::Mat> candidateMasks(const FrameContext& scene, const Click& click);

/// Returns the objectness of `mask`: high if it covers one object and nothing else. About 3 for a
/// good mask; the higher of two is better.
/// Criteria: colours unlike the ring's, a contour on edges of colour and depth, a solid shape, a
/// size that fits a hand, measured depth, no skin.
double objectness(const FrameContext& scene, const cv::Mat& mask);

/// Returns the diameter of a disc with the mask's area at the mask's depth, mm.
double widthInSpace_mm(const FrameContext& scene, const cv::Mat& mask);

}  // namespace hapticast::server
