// SPDX-License-Identifier: MIT
// JPEG encoding of the picture for the viewer's window. Thread: any.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Encodes `color` (CV_8UC3, BGR) as a JPEG. `quality` is clamped to 1..100. Returns an empty
/// vector if `color` is empty or cannot be encoded.
std::vector<std::uint8_t> encodePicture(const cv::Mat& color, int quality);

}  // namespace hapticast::server
