// SPDX-License-Identifier: MIT
// Merges the visible parts of an object that an occluder (for example, fingers) splits into pieces.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/appearance/graph_roi.hpp"

namespace hapticast::server {

/// Returns the piece `main` with the pieces of `mask` (0/255, size of `view`) that connect to it
/// behind an occluder. Fills small holes. `px_per_mm`: px of the view.
/// A piece connects if no pixel between both lies behind both, and if it does not reach the view's
/// border.
cv::Mat mergeOccludedParts(const GraphRoi& view, const cv::Mat& mask, const cv::Mat& main,
                           double px_per_mm);

}  // namespace hapticast::server
