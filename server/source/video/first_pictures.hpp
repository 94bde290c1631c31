// SPDX-License-Identifier: MIT
// What the first pictures of colour and depth say about a clip, for all sources with a video.
// Thread: any.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "server/source/picture/image_file.hpp"
#include "server/source/video_layout.hpp"

namespace hapticast::server {

/// Colour and depth whose lengths differ by up to so many frames are cut; a larger difference means
/// that they do not belong together.
inline constexpr std::uint64_t kCountTolerance = 5;

/// Sizes and kind of the first pictures.
struct FirstPictures {
  cv::Size color_size;
  cv::Size depth_size;
  DepthKind depth_kind = DepthKind::kMetric;
};

/// Returns what `color` and `raw`, the depth as the file has it, say. `code`: code of depth of 8
/// bits. Throws SourceError that names `depth_name` if the aspect ratios differ, if the depth has
/// false colours that `code` does not explain, or if depth in mm has a code.
[[nodiscard]] FirstPictures describeFirst(const cv::Mat& color, const cv::Mat& raw, DepthCode code,
                                          const std::string& depth_name);

/// Returns the rate that a file states, frames/s, or 25 (that of most films) if it is not
/// plausible.
[[nodiscard]] double plausibleRate(double stated_fps);

}  // namespace hapticast::server
