// SPDX-License-Identifier: MIT
// Separates and decodes the colour and the depth in the pictures of a video. Thread: any.
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
/// DepthCode::kHue the right or lower one. If the width or height is odd, the middle column or row
/// is in neither half. Requires `layout.layout` not to be kSeparate.
[[nodiscard]] PictureHalves splitPicture(const cv::Mat& picture, const VideoLayout& layout);

/// Decodes the depth picture `raw` of a video, and returns it in a form that toDepth() accepts.
/// kHue becomes CV_32FC1 in mm, with 0 where a pixel has no clear hue. kInverse becomes grey with
/// near white. Other pictures are unchanged.
[[nodiscard]] cv::Mat decodeDepth(const cv::Mat& raw, DepthCode code);

/// Guesses the layout of `picture` (CV_8UC3). Returns it as a phrase with the matching flags; "" if
/// no layout is likely.
[[nodiscard]] std::string guessLayout(const cv::Mat& picture);

}  // namespace hapticast::server
