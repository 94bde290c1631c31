// SPDX-License-Identifier: MIT
// Candidate masks for a point of the author (click): iterated graph cuts in regions of several
// sizes around it (GrabCut, Rother, Kolmogorov and Blake 2004). A score (objectness) compares them.
// Runs once for each object. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

// Merges the visible parts of an object that a nearer surface (for example, fingers) splits into
// pieces. Thread: the one that runs Vision.

/// Returns the piece `main`, together with those pieces of `mask` that probably are the same object
/// behind a nearer surface. Fills small holes. A piece is added if no pixel between it and `main`
/// lies behind both, and if it does not reach the border of the region. `mask`: 0/255, size of
/// `view`. `px_per_mm`: pixels of `view` for each mm.
cv::Mat mergeOccludedParts(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& main,
                           double px_per_mm);

/// A point of the author on an object (click), with the author's negative points and their colours.
struct Click {
  cv::Point at;
  const std::vector<cv::Point>& not_points;
  const NegativeColors& avoided;
  cv::Mat component;  ///< component of connected depth at the point, 0/255; empty: unknown
};

/// Returns up to eight different masks that contain the click (CV_8UC1, 0/255, size of the image).
std::vector<cv::Mat> candidateMasks(const FrameContext& scene, const Click& click);

/// Returns how well `mask` covers one object and nothing else (objectness): about 3 for a good
/// mask, higher is better. The score rises if the colours differ from those of the ring around the
/// mask. It rises if the contour lies on edges of colour and depth. It also rises with a solid
/// shape and with the share of measured depth. Skin lowers it, and so does a size that does not fit
/// a hand.
double objectness(const FrameContext& scene, const cv::Mat& mask);

/// Returns the object's width in space, mm: the diameter of a disc with the area of `mask` at the
/// depth of `mask`.
double widthInSpace_mm(const FrameContext& scene, const cv::Mat& mask);

}  // namespace hapticast::server
