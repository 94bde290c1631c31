// SPDX-License-Identifier: MIT
// Colours of the hand that holds one object, against the colours of this object: two mixtures of
// Gaussians (Bayes' rule, as in Jones and Rehg 2002). So an object with colours of skin differs
// from the hand that holds it. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/segment/appearance/color_mixture.hpp"

namespace hapticast::server {

/// Which colours are rather this hand's than this object's.
class HandColors {
 public:
  HandColors() = default;
  /// Learns the hand from the pixels of `lab` (CV_32FC3) where `hand` is not 0, and the object from
  /// those where `object` is not 0. The result is empty if one of them has fewer than eight pixels.
  HandColors(const cv::Mat& lab, const cv::Mat& hand, const cv::Mat& object)
      : hand_(lab, hand), object_(lab, object) {}

  [[nodiscard]] bool empty() const { return hand_.empty() || object_.empty(); }
  /// Returns 255 where `lab` (CV_32FC3) has the hand's colours, else 0.
  [[nodiscard]] cv::Mat find(const cv::Mat& lab) const;
  /// Returns 255 where `color` (CV_8UC3, BGR) has the hand's colours, else 0. Specks do not count.
  [[nodiscard]] cv::Mat findInPicture(const cv::Mat& color) const;

 private:
  ColorMixture hand_, object_;
};

}  // namespace hapticast::server
