// SPDX-License-Identifier: MIT
// Narrow-band contour decision: labels the pixels in a band around an object's contour anew, from
// colour, depth, planes and the last mask. A guided filter (He, Sun and Tang 2010) aligns the
// result with edges.
// Pixels outside the band do not change. README.md of server/vision has the sum. Thread: the one
// that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/color_histogram.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// Appearance model of an object across frames.
struct ContourMemory {
  ColorHistogram first;       ///< of the first mask; constant
  ColorHistogram now;         ///< of recent masks, adapts slowly
  ColorHistogram background;  ///< of the ring around the object
  ColorHistogram elsewhere;   ///< of the first picture without the object; may be empty
  ColorHistogram avoided;     ///< of the author's negative points; may be empty
  cv::Mat evidence;           ///< CV_32FC1 over a patch: the last decision, > 0: object
  cv::Matx33d to_picture;     ///< maps px of `evidence` to px of the picture
};

/// Warps the last decision into `patch`, the region of this frame.
void warpEvidence(ContourMemory& memory, const ObjectRoi& patch, const cv::Matx23d& similarity);

/// Returns the evidence for each colour bin, above 0 for the object; see colorEvidence().
std::vector<float> computeColorEvidence(const ContourMemory& memory);

/// Result of a contour decision.
struct ContourResult {
  cv::Mat mask;               ///< CV_8UC1, 0/255, over the patch's box at full size
  double inside_color = 0.0;  ///< mean colour evidence inside; below 0: not the object
};

/// Decides the contour in `patch`. Requires `memory.evidence` warped to `patch`, or empty. Replaces
/// `memory.evidence` by this frame's decision. Leaves the histograms unchanged; see updateMemory().
ContourResult decideContour(const ObjectRoi& patch, const DepthNoise& noise,
                            const std::vector<Plane>& planes, ContourMemory& memory);

/// Adds the colours of `mask` (CV_8UC1, 0/255, over the patch's box at full size) and of the ring
/// around it to `memory`. Requires a contour at most one band away from the patch's contour.
void updateMemory(const ObjectRoi& patch, const cv::Mat& mask, ContourMemory& memory);

}  // namespace hapticast::server
