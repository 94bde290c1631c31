// SPDX-License-Identifier: MIT
// Candidate masks for a point of the author (click): iterated graph cuts in regions of several
// sizes around it (GrabCut, Rother, Kolmogorov and Blake 2004). A score (objectness) compares them.
// Runs once for each object. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "server/vision/segment/annotate/clip_annotations.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Returns the piece `main`, together with those pieces of `mask` that probably are the same object
/// behind a nearer surface. Fills small holes. A piece is added if no pixel between the piece and
/// `main` is farther away than both, and if the piece does not touch the border of the region.
/// `mask`: 0/255, size of `view`. `px_per_mm`: pixels of `view` for each mm. A nearer surface is,
/// for example, a finger. Thread: the one that runs Vision.
cv::Mat mergeOccludedParts(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& main,
                           double px_per_mm);

/// A point of the author on an object (click), with the author's negative points and their colours.
struct Click {
  cv::Point at;
  const std::vector<cv::Point>& not_points;
  const NegativeColors& avoided;
  cv::Mat component;  ///< component of connected depth at the point, 0/255; empty: unknown
};

/// Candidates for the object at a click. All images are CV_8UC1, 0/255, size of the image.
struct Candidates {
  std::vector<cv::Mat> masks;  ///< different masks that contain the click
  cv::Mat hand;                ///< pixels with the colours of the holding hand; empty: unknown
};
/// Returns the candidates for `click`.
Candidates computeCandidates(const FrameContext& scene, const Click& click);

/// Terms of the objectness score of a mask. Shares are 0..1.
struct ObjectnessTerms {
  double apart = 0.0;  ///< distance of its colours from those of the ring around it (Bhattacharyya)
  double edge = 0.0;   ///< mean strength of the edges of colour or depth along the contour
  /// Share of the contour across which the depth continues. A pixel at a colour edge counts half.
  double contact = 0.0;
  double stray = 0.0;     ///< share of pixels farther from the median depth than the mask's width
  double skin = 0.0;      ///< share of pixels with colours of skin
  double width_mm = 0.0;  ///< diameter of a disc with its area
};

/// Returns the terms of `mask` (CV_8UC1, 0/255, size of the image). All are 0 if it has fewer than
/// ten pixels in the reduced region (GraphRoi).
ObjectnessTerms computeObjectnessTerms(const FrameContext& scene, const cv::Mat& mask);

/// Returns how well a mask with these terms covers one object and nothing else (objectness): about
/// 3 for a good mask, higher is better.
double objectness(const ObjectnessTerms& terms);
/// Returns the score and its terms for the log.
std::string toText(const ObjectnessTerms& terms);
/// Returns the score of `mask`.
double objectness(const FrameContext& scene, const cv::Mat& mask);

/// Returns the object's width in space, mm: the diameter of a disc with the area of `mask` at the
/// depth of `mask`.
double widthInSpace_mm(const FrameContext& scene, const cv::Mat& mask);

}  // namespace hapticast::server
