// SPDX-License-Identifier: MIT
// Reduced sizes: in large pictures, steps with a smooth result work on every second or third pixel,
// so that their time has a limit. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Picture width to which constants in px refer, px. Larger pictures are sampled more coarsely.
inline constexpr int kUsualWidth_px = 640;

/// Returns by how much a picture exceeds the usual one: 1 up to and below twice kUsualWidth_px.
inline int largestReduction(const cv::Size& picture) {
  return picture.width < kUsualWidth_px ? 1 : picture.width / kUsualWidth_px;
}

/// Returns the factor by which steps with a smooth result reduce a region of `region` px in a
/// picture of `picture` px. It is the smallest one that leaves at most `most_px` pixels, and at
/// most largestReduction().
inline int reductionFor(const cv::Size& region, const cv::Size& picture, double most_px) {
  const int largest = largestReduction(picture);
  for (int factor = 1; factor < largest; ++factor) {
    if (double(region.area()) / (factor * factor) <= most_px) return factor;
  }
  return largest;
}

}  // namespace hapticast::server
