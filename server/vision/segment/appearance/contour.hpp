// SPDX-License-Identifier: MIT
// Decides anew, from colour, depth, planes and the last mask, the band of pixels around an object's
// contour; what lies deeper inside or further out stays. README.md of server/vision gives the sum.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/color_histogram.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// What is remembered of an object between frames.
struct ContourMemory {
  ColorHistogram first;       ///< of the first mask; stays for good
  ColorHistogram now;         ///< follows slowly
  ColorHistogram background;  ///< of the ring around the object
  ColorHistogram elsewhere;   ///< of the whole picture it began in, without it; may be empty
  ColorHistogram avoided;     ///< of what the author does not mean; may be empty
  cv::Mat evidence;           ///< CV_32FC1 over a patch: the last decision, > 0 object
  cv::Matx33d to_picture;     ///< of `evidence`
};

/// Carries the last decision into the patch of this frame.
void warpEvidence(ContourMemory& memory, const ObjectRoi& patch, const cv::Matx23d& similarity);

/// By colour bin, above 0 speaks for the object; see colorEvidence().
std::vector<float> computeColorEvidence(const ContourMemory& memory);

struct ContourResult {
  cv::Mat mask;               ///< CV_8UC1, 0 / 255, over the patch's box at full size
  double inside_color = 0.0;  ///< mean colour evidence inside; below 0 it is not the object
};

/// `memory.evidence` must be carried to the patch (or empty); it is replaced by this frame's. The
/// histograms are not touched; see learn().
ContourResult decideContour(const ObjectRoi& patch, const DepthNoise& noise,
                            const std::vector<Plane>& planes, ContourMemory& memory);

/// Takes the colours of `mask` (0 / 255, over the patch's box at full size) and of the ring around
/// it into the memory. Its contour is at most a band away from the patch's.
void updateMemory(const ObjectRoi& patch, const cv::Mat& mask, ContourMemory& memory);

}  // namespace hapticast::server
