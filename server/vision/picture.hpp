// SPDX-License-Identifier: MIT
// The picture for the viewer's window.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// `color` (CV_8UC3, BGR) as a JPEG, `quality` 1..100 (cut to it). Empty when there is no picture
/// or it cannot be encoded. Thread: any.
std::vector<std::uint8_t> encodePicture(const cv::Mat& color, int quality);

}  // namespace hapticast::server
