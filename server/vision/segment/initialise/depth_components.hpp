// SPDX-License-Identifier: MIT
// A thing behind fingers is seen in pieces. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/appearance/graph_roi.hpp"

namespace hapticast::server {

/// Of `mask` (0 / 255, of `view`) the piece `main` and those that are one with it behind what
/// passes in front of them: nothing that is seen between them lies behind both, and none of them
/// reaches the view's border. Small holes are filled. `px_per_mm`: of the view.
cv::Mat mergeOccludedParts(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& main,
                           double px_per_mm);

}  // namespace hapticast::server
