// SPDX-License-Identifier: MIT
// Pictures from the stream. Thread: any.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <span>

namespace hapticast::client {

/// Decodes to CV_8UC3. Empty unless it is a whole JPEG of exactly `expected` size: what comes from
/// outside says how much memory a decoder takes, so it is held against the announced picture first.
cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected);

}  // namespace hapticast::client
