// SPDX-License-Identifier: MIT
// Scales depth to the size of the colour picture. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Returns whether both sizes have the same aspect ratio, within 1 %.
[[nodiscard]] bool isSameAspect(cv::Size a, cv::Size b);

/// Returns what to do about depth whose aspect ratio is not that of the colour, as the end of an
/// error message: to turn it if it lies on its side, else to scale it.
[[nodiscard]] std::string aspectRemedy(cv::Size depth, cv::Size color);

/// Returns `depth` (CV_32FC1) at the size of `color` (CV_8UC3). It interpolates no values, because
/// a mean of near and far, or of a depth and "not measured", is no valid depth. Each pixel has the
/// value of the nearest pixel of `depth`, except where depth is enlarged near a depth edge. There
/// the colours decide on which side of the edge a pixel is (a variant of joint bilateral
/// upsampling, Kopf et al. 2007, that selects one side). A pixel whose nearest pixel is not
/// measured is not measured either. Returns `depth` itself if it has this size.
[[nodiscard]] cv::Mat scaleDepth(const cv::Mat& depth, DepthKind kind, const cv::Mat& color);

/// Logs that the depth in `place` has the size `from` and is scaled to `to`.
void logScaledDepth(const std::string& place, cv::Size from, cv::Size to);

}  // namespace hapticast::server
