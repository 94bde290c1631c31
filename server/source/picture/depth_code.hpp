// SPDX-License-Identifier: MIT
// Takes colour and depth from the pictures of a video. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Halves of one picture.
struct PictureHalves {
  cv::Mat color;
  cv::Mat depth;
};

/// Returns the halves of `picture` (views of it). Colour is the left or upper half, but with
/// DepthCode::kHue the right or lower one. A column or row in the middle that is left over is in
/// neither. `layout.layout` is not kSeparate.
[[nodiscard]] PictureHalves splitPicture(const cv::Mat& picture, const VideoLayout& layout);

/// Returns a depth picture of a video (`raw`) as toDepth() expects it. Hue becomes CV_32FC1 in mm,
/// with 0 where a pixel has no clear hue. Inverse becomes grey with near white. Other pictures stay
/// as they are.
[[nodiscard]] cv::Mat decodeDepth(const cv::Mat& raw, DepthCode code);

/// Returns what the halves of `picture` (CV_8UC3) look like, with the flags for it; "" if nothing
/// is likely.
[[nodiscard]] std::string guessLayout(const cv::Mat& picture);

}  // namespace hapticast::server
