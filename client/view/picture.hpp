// SPDX-License-Identifier: MIT
// JPEG decoder for pictures of the stream.
// Thread: any (pure function).
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>

namespace hapticast::client {

/// Decodes `jpeg`. Returns CV_8UC3 (BGR), empty unless `jpeg` is a complete, valid JPEG of the size
/// `expected`. The header of a JPEG determines the memory of its decoder. So the size is checked
/// before the decoding.
[[nodiscard]] cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected);

}  // namespace hapticast::client
