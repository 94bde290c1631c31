// SPDX-License-Identifier: MIT
// Shot boundary detection: finds the frames at which a clip cuts to another scene, by correlation
// of brightness and change of depth. State of the old scene is invalid after a cut.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/base/frame_images.hpp"

namespace hapticast::server {

/// Compares successive frames at 1/16 of their size. A cut is where both brightness and depth
/// differ from the last frame. Motion, pans and changes of light change only one of them, or both a
/// little.
class SceneCuts {
 public:
  /// Returns whether a cut lies directly before this frame; false for the first frame.
  bool next(const FrameImages& images);

 private:
  cv::Mat gray_;   // CV_32FC1, small
  cv::Mat depth_;  // CV_32FC1, small, mm; 0: not measured
};

}  // namespace hapticast::server
