// SPDX-License-Identifier: MIT
// Discriminative correlation filter with channel and spatial reliability (CSRT, Lukezic and others
// 2017): follows the box of an object whose mask is in doubt. It proposes a place for the mask and
// for the search. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/tracking.hpp>
#include <optional>

namespace hapticast::server {

/// Box of one object, from the last frame in which its mask was sure.
class BoxTracker {
 public:
  /// Begins at `box` (px) of the picture `color` (CV_8UC3). Requires a box of kSmallestBox_px each
  /// way inside the picture.
  BoxTracker(const cv::Mat& color, const cv::Rect& box);
  /// Returns the box in the next picture, px, or nullopt if the filter does not find it.
  std::optional<cv::Rect> next(const cv::Mat& color);

  /// Least width and height of a box, px. The value is a choice: a filter needs some texture.
  static constexpr int kSmallestBox_px = 8;

 private:
  [[nodiscard]] cv::Mat shrinkPicture(const cv::Mat& color) const;

  double shrink_;
  cv::Ptr<cv::TrackerCSRT> filter_;
};

}  // namespace hapticast::server
