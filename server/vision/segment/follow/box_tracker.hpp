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
  /// Begins at `box` (px, inside the picture) of the picture `color` (CV_8UC3). A box that is too
  /// small or too long for the filter is not followed.
  BoxTracker(const cv::Mat& color, const cv::Rect& box);
  /// Returns the box in the next picture, px, or nullopt if the filter does not find it. After that
  /// it returns nullopt for all pictures.
  std::optional<cv::Rect> next(const cv::Mat& color);

 private:
  [[nodiscard]] cv::Mat shrinkPicture(const cv::Mat& color) const;

  double shrink_;
  cv::Ptr<cv::TrackerCSRT> filter_;  // null: nothing is followed
};

}  // namespace hapticast::server
