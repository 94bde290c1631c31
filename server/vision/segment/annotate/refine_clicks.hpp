// SPDX-License-Identifier: MIT
// A mask corrected by the author's points: one graph cut in which what is far from the points stays
// as it was. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/appearance/graph_roi.hpp"

namespace hapticast::server {

/// `mask` (0 / 255, size of the picture) with what belongs to the points of `annotation` that are
/// the object, and without what belongs to those that are none; empty where nothing is left.
cv::Mat refineWithClicks(const FrameContext& scene, const cv::Mat& mask,
                         const Annotation& annotation);

}  // namespace hapticast::server
