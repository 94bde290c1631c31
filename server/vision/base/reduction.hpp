// SPDX-License-Identifier: MIT
// Reduced sizes: in large pictures, algorithms with a smooth result sample every second or third
// pixel, which bounds their run time. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

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
inline int computeReduction(const cv::Size& region, const cv::Size& picture, double most_px) {
  const int largest = largestReduction(picture);
  for (int factor = 1; factor < largest; ++factor) {
    if (double(region.area()) / (factor * factor) <= most_px) return factor;
  }
  return largest;
}

/// Returns every `by`-th pixel and row of `image`; `image` itself if `by` is 1.
inline cv::Mat sampleEvery(const cv::Mat& image, int by) {
  if (by == 1) return image;
  cv::Mat out;
  cv::resize(image, out, image.size() / by, 0, 0, cv::INTER_NEAREST);
  return out;
}

}  // namespace hapticast::server
