// SPDX-License-Identifier: MIT
// Where in the whole picture a lost object may be.
#pragma once

#include <opencv2/core.hpp>

#include "server/vision/base/frame_images.hpp"
#include "server/vision/segment/color.hpp"

namespace hapticast::server {

/// The largest region (0 / 255) that has these colours rather than the picture's, 0.25 to 3 times
/// `area_px`, without what lies far nearer or further than `depth_mm`. Empty: there is none.
cv::Mat likeliestPlace(const FrameImages& images, const ColorHistogram& colors, double depth_mm,
                       double area_px);

}  // namespace hapticast::server
