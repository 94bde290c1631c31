// SPDX-License-Identifier: MIT
// Where a clip cuts from one scene to another: nothing of what was known holds on.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/base/frame_images.hpp"

namespace hapticast::server {

/// Compares frames in order, at some 40 x 30 px. A cut is where neither brightness nor depth is
/// like the last frame's: what moves, pans or gets brighter changes one of them, or both a little.
class SceneCuts {
 public:
  /// Whether there is a cut just before this frame; never before the first.
  bool next(const FrameImages& images);

 private:
  cv::Mat gray_;   // CV_32FC1, small
  cv::Mat depth_;  // CV_32FC1, small, mm; 0: not measured
};

}  // namespace hapticast::server
