// SPDX-License-Identifier: MIT
// Decodes pictures of the stream. Thread: any.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>

namespace hapticast::client {

/// Decodes to CV_8UC3 (BGR). Returns an empty picture unless `jpeg` is a whole, flawless JPEG of
/// exactly `expected` size. A JPEG says itself how much memory its decoder takes, so its header is
/// read first and held against the size that the stream announced.
[[nodiscard]] cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected);

}  // namespace hapticast::client
