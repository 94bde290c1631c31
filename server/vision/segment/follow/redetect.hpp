// SPDX-License-Identifier: MIT
// A second look at an object that is known: one graph cut by what is remembered of it, around where
// it should be or over the whole picture. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/appearance/contour.hpp"
#include "server/vision/segment/appearance/graph_roi.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

struct KnownObject {
  const ContourMemory& memory;
  ObjectLimits limits;
  double usual_px = 0.0;  ///< its area in pictures, when nothing hides it
  cv::Mat mask;           ///< where it is expected, 0 / 255, size of the picture; empty: anywhere
};

/// The mask of it in this picture; empty: nothing is like it.
cv::Mat redetect(const FrameContext& scene, const KnownObject& known);

/// How much `mask` is like one thing, and this one: its first colours, its usual area. About 4.
double reidentificationScore(const FrameContext& scene, const KnownObject& known,
                             const cv::Mat& mask);

}  // namespace hapticast::server
