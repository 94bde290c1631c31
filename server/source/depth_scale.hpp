// SPDX-License-Identifier: MIT
// Scales depth to the size of the colour picture. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace hapticast::server {

/// Returns whether both sizes have the same aspect ratio, within 1 %.
[[nodiscard]] bool sameAspect(cv::Size a, cv::Size b);

/// Returns `depth` (CV_32FC1) at `size`. Each pixel has the value of its nearest pixel. So no value
/// at an edge is a mixture of near and far, or of a depth and "not measured". Returns `depth`
/// itself if it has this size.
[[nodiscard]] cv::Mat scaleDepth(const cv::Mat& depth, cv::Size size);

/// Logs that the depth in `place` has the size `from` and is scaled to `to`.
void logScaledDepth(const std::string& place, cv::Size from, cv::Size to);

}  // namespace hapticast::server
