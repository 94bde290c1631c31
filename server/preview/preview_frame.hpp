// SPDX-License-Identifier: MIT
// What --preview shows of a clip: frames kept as vision gives them, and counts of all. Thread: any;
// values.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// One frame as it would be felt, beside what the source gave.
struct PreviewFrame {
  double time_s = 0.0;  ///< in the clip
  cv::Mat color;        ///< CV_8UC3
  cv::Mat depth;        ///< CV_32FC1, as the source gives it
  HapticFrame haptic;
};

/// 255 where object `id` (all its layers) is felt, else 0; size of the picture.
[[nodiscard]] cv::Mat renderMask(const HapticFrame& frame, std::uint32_t id, const cv::Size& size);
/// The heights of all objects in nominal mm, NaN where nothing is felt.
[[nodiscard]] cv::Mat renderHeights(const HapticFrame& frame, const cv::Size& size);
/// The objects' ids, each once, in order.
[[nodiscard]] std::vector<std::uint32_t> listIds(const HapticFrame& frame);

/// What is told of one object of a frame.
struct ObjectFacts {
  std::uint32_t id = 0;
  double share = 0.0;                  ///< of the picture
  double near = 0.0, far = 0.0;        ///< 2 and 98 % of its depths, in the source's unit
  double low_mm = 0.0, high_mm = 0.0;  ///< 2 and 98 % of its heights, nominal
  /// The depths that become heights 30 and 0, found from depths and heights, in the source's unit;
  /// nullopt where the object is too flat to tell.
  std::optional<DepthRange> mapped;
};
[[nodiscard]] ObjectFacts objectStats(const PreviewFrame& frame, std::uint32_t id,
                                      const Workspace& workspace);
/// One line for people; `unit` is of depth.
[[nodiscard]] std::string toText(const ObjectFacts& facts, DepthKind kind);

}  // namespace hapticast::server
