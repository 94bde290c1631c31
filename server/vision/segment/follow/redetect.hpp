// SPDX-License-Identifier: MIT
// Re-detection: searches for a lost object by its appearance model with one graph cut. It searches
// around the expected position or in the whole picture. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/appearance/contour.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Model of the object to search for: its appearance, its limits of depth, and its usual size.
struct KnownObject {
  const ContourMemory& memory;
  ObjectLimits limits;
  double usual_px = 0.0;  ///< area in the picture when nothing hides the object, px
  cv::Mat mask{};         ///< expected mask, 0/255, size of the image; empty: unknown
  /// Part of the picture to search, px. Empty: the surroundings of `mask`, or the whole picture if
  /// `mask` is empty.
  cv::Rect window{};
};

/// Searches for the object in this frame. Returns its mask (CV_8UC1, 0/255, size of the image), or
/// an empty mask if nothing was found.
cv::Mat redetect(const FrameContext& scene, const KnownObject& known);

/// Returns the score of the hypothesis that `mask` is the object `known`: about 4 for a good mask,
/// higher is better. The score is the sum of objectness(), the similarity to the object's first
/// colours, and the similarity to its usual area.
double reidentificationScore(const FrameContext& scene, const KnownObject& known,
                             const cv::Mat& mask);

}  // namespace hapticast::server
