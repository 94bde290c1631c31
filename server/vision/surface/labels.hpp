// SPDX-License-Identifier: MIT
// Pieces of a surface under labels (CV_8UC1 over its box, 0: none). Thread: any; values.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Connected pieces of `where` that are large enough: labels 1 .. (0: none of them), and how many.
int largePieces(const cv::Mat& where, int smallest_px, cv::Mat& labels);

/// Of labels 1 .. count; 0 where a label has no pixel.
std::vector<double> meanDepths(const Surface& surface, const cv::Mat& labels, int count);

/// Every pixel of the mask gets a label: from its neighbours, ring by ring; what touches none by
/// its depth alone.
cv::Mat grownLabels(const Surface& surface, int count, const cv::Mat& seeds);

}  // namespace hapticast::server
