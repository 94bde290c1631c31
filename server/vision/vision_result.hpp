// SPDX-License-Identifier: MIT
// Result of vision for one frame. Thread: any.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/haptic_frame.hpp"

namespace hapticast::server {

/// A complete frame with its picture. A frame is complete `lookahead` frames after its push(),
/// because its motion depends on later frames too, and one frame later with two threads.
struct VisionResult {
  HapticFrame frame;  ///< the frame, with the reliefs of all its objects
  cv::Mat color;      ///< picture of the same frame
  /// For each object of `frame` the heights that this frame alone measured, over the rectangle and
  /// mask of its relief; null: none. Empty without VisionSettings::offline.
  std::vector<std::shared_ptr<const Relief>> measured = {};
};

}  // namespace hapticast::server
