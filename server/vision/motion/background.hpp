// SPDX-License-Identifier: MIT
// How far the background moves behind the objects, for those who feel a panning camera's motion
// taken off. Thread: vision's.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// The background's own flow at half size: a pan is the same everywhere, and corners of half size
/// are as good (measured: an acceleration that a pan puts off by 26 % is off by 2.3 % then).
class BackgroundMotion {
 public:
  /// What stands before the background: a mask (0 / 255) and a place in it, px.
  struct Object {
    cv::Mat mask;
    cv::Point2d at_px;
  };

  /// The next picture (CV_8UC1) with the objects as they were in the last one. Returns how far the
  /// background has moved since then at each object's place, px; 0 where it stands or is not known.
  std::vector<cv::Vec2d> next(const cv::Mat& gray, const std::vector<Object>& objects);

 private:
  cv::Mat last_small_;
  cv::Vec2d last_step_px_{0, 0};
};

}  // namespace hapticast::server
