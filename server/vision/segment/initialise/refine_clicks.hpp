// SPDX-License-Identifier: MIT
// Interactive segmentation (Boykov and Jolly 2001): corrects a mask with one minimum cut. The input
// is a set of points that the author of the clip placed on the object and beside it. Far from the
// points, the cut prefers the old mask. It may still remove small pieces, and pixels with the
// colours of negative points. Thread: the one that runs Vision.
#pragma once

#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/segment/annotate/annotation_track.hpp"
#include "server/vision/segment/appearance/object_roi.hpp"

namespace hapticast::server {

/// Returns `mask`, corrected by the author's points. The regions of positive points are added, and
/// the regions of negative points are removed. `held`: earlier positive points, px. Their discs
/// remain, but they add no region. If there are only positive points, and the result would cover
/// more than `most_px` pixels without a clearly better objectness(), only the discs of the points
/// are added, because the result then includes a hand. All pixels are 0 if nothing remains. `mask`
/// and the result: CV_8UC1, 0/255, size of the image.
cv::Mat refineWithClicks(const FrameContext& scene, const cv::Mat& mask,
                         const Annotation& annotation, const std::vector<cv::Point>& held,
                         double most_px = std::numeric_limits<double>::infinity());

}  // namespace hapticast::server
