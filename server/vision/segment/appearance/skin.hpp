// SPDX-License-Identifier: MIT
// Skin detection by colour: finds possible hands in the light of this scene, with a white balance
// by the grey pixels. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Skin colours in one light.
class SkinColors {
 public:
  SkinColors() = default;
  /// Returns the skin colours in the light of `color` (CV_8UC3), corrected by the cast of its
  /// nearly grey pixels.
  static SkinColors adaptedToLight(const cv::Mat& color);

  [[nodiscard]] bool empty() const { return is_skin_.empty(); }
  /// Returns a mask: 255 where `color` shows skin at least as wide as a finger, so that specks do
  /// not count. `color`: CV_8UC3, a picture about 640 px wide, or a part of it.
  [[nodiscard]] cv::Mat in(const cv::Mat& color) const;

 private:
  std::vector<unsigned char> is_skin_;  // by colour bin, 32 x 32 x 32
};

}  // namespace hapticast::server
