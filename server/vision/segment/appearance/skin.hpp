// SPDX-License-Identifier: MIT
// Where hands may be, by their colour in the light of this scene. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// The colours of skin in one light.
class SkinColors {
 public:
  SkinColors() = default;
  /// Of the light in `color` (CV_8UC3): the cast of what is nearly grey is taken out.
  static SkinColors adaptedToLight(const cv::Mat& color);

  [[nodiscard]] bool empty() const { return is_skin_.empty(); }
  /// 255 where `color` (CV_8UC3; a picture about 640 px wide, or a part of it) shows skin as wide
  /// as a finger: fur that has specks of its colour does not count.
  [[nodiscard]] cv::Mat in(const cv::Mat& color) const;

 private:
  std::vector<unsigned char> is_skin_;  // by colour, 32 x 32 x 32
};

}  // namespace hapticast::server
