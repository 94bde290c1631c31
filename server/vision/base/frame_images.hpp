// SPDX-License-Identifier: MIT
// One frame as the stages of vision see it: colour, grey and *working depth*. Nobody writes into
// these images (rgbd_source.hpp tells the rule), so they are passed on and kept without copies.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// 8-bit depth works as mm too: 255 is near, 0 is far, of the range the source or the author gives,
/// else of this one. Mapped over exactly that range it gives height = h / 255 * 30 mm, as the
/// thesis does.
inline constexpr DepthRange kHeightRange{600.0, 1000.0};

/// What constants in px are made for; larger pictures have detail to spare.
inline constexpr int kUsualWidth_px = 640;

struct FrameImages {
  cv::Mat color;  ///< CV_8UC3, BGR
  cv::Mat gray;   ///< CV_8UC1
  cv::Mat depth;  ///< CV_32FC1, working depth in mm, 0 = no measurement; always finite
  cv::Mat mask;   ///< the source's: empty, or CV_8UC1 with n for object n
  /// What the author drew of this frame: empty (most frames), or as `mask`, which is then empty.
  cv::Mat key_mask;
};

/// Checks types and sizes (throws SourceError) and makes the working images. Depths that are not
/// finite, not positive or beyond 100 m count as not measured.
FrameImages makeFrameImages(const RgbdFrame& frame, const SourceInfo& info);

/// Whether two images of one type are the same, pixel by pixel. Ends at the first row that differs,
/// which is nearly always an early one.
bool equalImages(const cv::Mat& a, const cv::Mat& b);
/// Whether colour, depth and masks are.
bool equalImages(const FrameImages& a, const FrameImages& b);

}  // namespace hapticast::server
