// SPDX-License-Identifier: MIT
// Working images of a frame: colour, grey and *working depth* in mm, the common input of all stages
// of vision.
// No code writes into these images (rule in rgbd_source.hpp), so stages share them without copies.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Range of 8-bit depth, whose level 255 is near and 0 is far, if neither the source nor the author
/// states a range. Mapped over this range a level h becomes height = h / 255 * 30 mm, as in the
/// thesis.
inline constexpr DepthRange kHeightRange{600.0, 1000.0};

/// Picture width that constants in px assume, px. Larger pictures are sampled more coarsely.
inline constexpr int kUsualWidth_px = 640;

/// Images of one frame, all of one size.
struct FrameImages {
  cv::Mat color;  ///< CV_8UC3, BGR
  cv::Mat gray;   ///< CV_8UC1
  cv::Mat depth;  ///< CV_32FC1, working depth in mm, 0: not measured; finite
  cv::Mat mask;   ///< the source's mask: empty, or CV_8UC1 with n for object n
  /// The author's key mask: empty in most frames, or CV_8UC1 with n for object n; then `mask` is
  /// empty.
  cv::Mat key_mask;
};

/// Converts `frame` to working images. Depths that are not finite, not positive or beyond 100 m
/// count as not measured. Throws SourceError if a type or a size differs from `info`.
FrameImages makeFrameImages(const RgbdFrame& frame, const SourceInfo& info);

/// Returns whether two images of one type have equal pixels. Stops at the first row that differs.
bool equalImages(const cv::Mat& a, const cv::Mat& b);
/// Returns whether colour, depth and masks are equal.
bool equalImages(const FrameImages& a, const FrameImages& b);

}  // namespace hapticast::server
