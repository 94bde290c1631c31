// SPDX-License-Identifier: MIT
// Re-detection: searches for an object by its appearance model with one graph cut, around its
// expected position or in the whole picture. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/appearance/contour.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Model of the object to search for.
struct KnownObject {
  const ContourMemory& memory;
  ObjectLimits limits;
  double usual_px = 0.0;  ///< usual area in the picture without occlusion
  cv::Mat mask;           ///< expected mask, 0/255, image size; empty: anywhere
};

/// Searches this frame for the object. Returns its mask (CV_8UC1, 0/255, image size); empty if no
/// piece was found.
cv::Mat redetect(const FrameContext& scene, const KnownObject& known);

/// Returns the score of `mask` as this object: objectness, similarity to its first colours, usual
/// area. About 4 for a good mask; higher is better.
double reidentificationScore(const FrameContext& scene, const KnownObject& known,
                             const cv::Mat& mask);

}  // namespace hapticast::server
