// SPDX-License-Identifier: MIT
// Scales pictures that are larger than the stream allows (kMaxWidth_px x kMaxHeight_px of
// common/haptic_frame.hpp). Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "server/source/rgbd_source.hpp"

namespace hapticast::server {

/// Returns the size at which a source delivers pictures of the size `own`: `own` if the stream
/// allows it, else the largest size of the same aspect ratio that it allows. At least 1x1.
[[nodiscard]] cv::Size fitSize(cv::Size own);

/// Sets the size of the frames in `info`, and its scale, for pictures of the size `own`. Logs a
/// line that names `place` if the pictures are scaled.
void setSize(SourceInfo& info, cv::Size own, const std::string& place);

/// Returns the size of the frames of `info`.
[[nodiscard]] cv::Size frameSize(const SourceInfo& info);

/// Returns the size of the clip's own pictures.
[[nodiscard]] cv::Size ownSize(const SourceInfo& info);

/// Returns `color` (CV_8UC3) at `size`, each pixel as the mean of the area that it covers. Returns
/// `color` itself if it has this size. Requires `size` to be at most the size of `color`.
[[nodiscard]] cv::Mat scaleColor(const cv::Mat& color, cv::Size size);

/// Returns `mask` (CV_8UC1) at `size`, each pixel with the value of its nearest pixel.
[[nodiscard]] cv::Mat scaleMask(const cv::Mat& mask, cv::Size size);

/// Converts `camera` from the clip's own pictures to the frames of `info`, and returns it.
[[nodiscard]] CameraModel scaleCamera(const CameraModel& camera, const SourceInfo& info);

}  // namespace hapticast::server
