// SPDX-License-Identifier: MIT
// Interactive segmentation (Boykov and Jolly 2001): corrects a mask by the author's points with one
// minimum cut. Pixels far from the points keep their label. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Returns `mask` (CV_8UC1, 0/255, image size) with the regions of the positive points of
/// `annotation` and without those of its negative points. Empty (all 0) if no pixel remains.
cv::Mat refineWithClicks(const FrameContext& scene, const cv::Mat& mask,
                         const Annotation& annotation);

}  // namespace hapticast::server
