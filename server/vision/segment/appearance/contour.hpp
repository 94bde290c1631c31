// SPDX-License-Identifier: MIT
// Narrow-band contour decision: decides which pixels of a band around an object's contour belong to
// the object. The decision is the sum of evidence from colour, depth, planes, shape and the last
// frame. A guided filter (He, Sun and Tang 2010) aligns the result with edges of the picture.
// Pixels outside the band do not change. README.md of server/vision has the formula. Thread: the
// one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/appearance/color_histogram.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"
#include "server/vision/segment/appearance/planes.hpp"

namespace hapticast::server {

/// Appearance model of an object, which persists from frame to frame.
struct ContourMemory {
  ColorHistogram first;       ///< colours of the first mask; constant
  ColorHistogram now;         ///< colours of recent masks; adapts slowly
  ColorHistogram background;  ///< colours of the ring around the object
  ColorHistogram elsewhere;   ///< colours of the first picture outside the object; may be empty
  ColorHistogram avoided;     ///< colours of the author's negative points; may be empty
  ColorHistogram hand;        ///< colours of the hand that holds the object; may be empty
  cv::Mat evidence;           ///< evidence of the last decision, CV_32FC1 over a patch; > 0: object
  cv::Mat shape;  ///< mean of the masks of the last second, moved with the object: -1..1, CV_32FC1
  cv::Matx33d to_picture;  ///< maps px of `evidence` and of `shape` to px of the picture

  /// Deletes `evidence` and `shape`. Call it if the object is at another place.
  void forgetPlace();
};

/// Moves `memory.evidence` and `memory.shape` by `similarity` into the region of `patch`, which
/// belongs to this frame. `similarity` maps px of the last picture to px of this picture.
void warpEvidence(ContourMemory& memory, const ObjectRoi& patch, const cv::Matx23d& similarity);

/// Returns the evidence of each colour bin from the histograms of `memory`: above 0 for colours of
/// the object. See colorEvidence().
std::vector<float> computeColorEvidence(const ContourMemory& memory);

/// Result of a contour decision.
struct ContourResult {
  cv::Mat mask;               ///< CV_8UC1, 0/255, over the patch's box at full size
  double inside_color = 0.0;  ///< mean colour evidence inside the mask; below 0: not the object
};

/// Decides which pixels of the band in `patch` belong to the object, and returns the new mask.
/// Replaces `memory.evidence` by the evidence of this frame. Call warpEvidence() before, or leave
/// `memory.evidence` empty. The histograms do not change; see updateMemory().
ContourResult decideContour(const ObjectRoi& patch, const DepthNoise& noise,
                            const std::vector<Plane>& planes, ContourMemory& memory);

/// Adds `mask` to memory.shape with the weight 1/30: a moving mean of about 30 masks. Pixels where
/// the object is hidden do not change. If the shape is empty, `mask` becomes the shape. `mask`:
/// CV_8UC1, 0/255, over the patch's box at full size. `is_whole`: false if `mask` may be only a
/// part of the object; pixels outside `mask` are then no evidence of background. Requires
/// memory.to_picture to be that of the patch, or an empty shape.
void updateShape(const ObjectRoi& patch, const cv::Mat& mask, bool is_whole, ContourMemory& memory);

/// Updates the histograms of `memory` with the colours of `mask` and of the ring around it. `mask`:
/// CV_8UC1, 0/255, over the patch's box at full size. The contour of `mask` must be at most one
/// band's width away from the contour of the patch.
void updateMemory(const ObjectRoi& patch, const cv::Mat& mask, ContourMemory& memory);

}  // namespace hapticast::server
