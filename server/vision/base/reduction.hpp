// SPDX-License-Identifier: MIT
// Downsampling factors. In large pictures, algorithms whose result is smooth use only every second
// or third pixel. That bounds their run time. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace hapticast::server {

/// Picture width for which the constants in px were chosen, px. Larger pictures are downsampled.
inline constexpr int kUsualWidth_px = 640;

/// Returns the largest downsampling factor for a picture: its width over kUsualWidth_px, rounded
/// down, but at least 1.
inline int largestReduction(const cv::Size& picture) {
  return picture.width < kUsualWidth_px ? 1 : picture.width / kUsualWidth_px;
}

/// Returns the downsampling factor for a region of the size `region` in a picture of the size
/// `picture`, px. It is the smallest factor that leaves at most `most_px` pixels, but at most
/// largestReduction().
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
