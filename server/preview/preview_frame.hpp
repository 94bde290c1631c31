// SPDX-License-Identifier: MIT
// Frames of the preview: results of vision beside the source's images. Functions compute masks,
// heights and facts of each object from them. Thread: any.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/haptic_frame.hpp"
#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Result of vision for one frame, with the source's images.
struct PreviewFrame {
  double time_s = 0.0;  ///< time in the clip, s
  cv::Mat color;        ///< CV_8UC3
  cv::Mat depth;        ///< CV_32FC1, from the source
  HapticFrame haptic;
  Vec2 own_px = Vec2::Ones();  ///< SourceInfo::own_px
};

/// Returns the mask of object `id` with all its layers: CV_8UC1, 0/255, of size `size`.
[[nodiscard]] cv::Mat renderMask(const HapticFrame& frame, std::uint32_t id, const cv::Size& size);
/// Returns the heights of all objects: CV_32FC1, nominal mm, of size `size`. They are NaN outside
/// the objects.
[[nodiscard]] cv::Mat renderHeights(const HapticFrame& frame, const cv::Size& size);
/// Returns the objects' ids, each once, in ascending order.
[[nodiscard]] std::vector<std::uint32_t> listIds(const HapticFrame& frame);

/// Facts about one object of a frame.
struct ObjectFacts {
  std::uint32_t id = 0;
  double share = 0.0;                  ///< share of the picture's pixels, 0..1
  double near = 0.0, far = 0.0;        ///< 2 and 98 % quantiles of its depths, in the source's unit
  double low_mm = 0.0, high_mm = 0.0;  ///< 2 and 98 % quantiles of its heights, nominal
  /// Mapped range (depths that become heights 30 and 0), in the source's unit. It is estimated by a
  /// fit to the object's depths and heights; nullopt: the object is too flat.
  std::optional<DepthRange> mapped;
};
/// Returns the facts about object `id` of `frame`.
[[nodiscard]] ObjectFacts objectStats(const PreviewFrame& frame, std::uint32_t id,
                                      const Workspace& workspace);
/// Returns the facts as one line of text. `kind` determines the unit of depth.
[[nodiscard]] std::string toText(const ObjectFacts& facts, DepthKind kind);

}  // namespace hapticast::server
