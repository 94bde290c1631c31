// SPDX-License-Identifier: MIT
// Edge sharpening for estimated depth. An estimator blurs a depth edge to a ramp some 15 px wide.
// The ramp's pixels are those whose slope no usual surface has. Along its gradient a ramp ends in
// two surfaces, a near and a far one. The colours of both ends decide to which one each pixel
// belongs (a binary joint bilateral filter). The pixel then continues that surface. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Returns `depth` (CV_32FC1, mm, 0: not measured) with its edges at the edges of `color` (CV_8UC3,
/// same size). Returns `depth` itself if it has no ramp.
[[nodiscard]] cv::Mat sharpenEdges(const cv::Mat& depth, const cv::Mat& color);

}  // namespace hapticast::server
