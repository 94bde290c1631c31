// SPDX-License-Identifier: MIT
// Skin detection by colour: finds pixels that may be hands. It adapts to the light of the scene by
// a white balance from the nearly grey pixels. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// The colours that skin can have in the light of one scene.
class SkinColors {
 public:
  SkinColors() = default;
  /// Returns the skin colours in the light of the picture `color` (CV_8UC3). The nearly grey pixels
  /// show the colour of the light.
  static SkinColors adaptToLight(const cv::Mat& color);

  [[nodiscard]] bool empty() const { return kinds_.empty(); }
  /// Returns a mask: 255 where `color` has the colour of skin. Areas narrower than a finger do not
  /// count. `color`: CV_8UC3, a picture about 640 px wide, or a part of it.
  [[nodiscard]] cv::Mat findSkin(const cv::Mat& color) const { return find(color, kSkin); }
  /// Returns the mask of findSkin() together with dark skin. Dark brown things have the same
  /// colours as dark skin, so the caller needs other evidence of a hand.
  [[nodiscard]] cv::Mat findWithDark(const cv::Mat& color) const { return find(color, kDarkSkin); }

 private:
  enum Kind : unsigned char { kNone, kDarkSkin, kSkin };
  [[nodiscard]] cv::Mat find(const cv::Mat& color, Kind least) const;

  std::vector<unsigned char> kinds_;  // by colour bin, 32 x 32 x 32
};

}  // namespace hapticast::server
