// SPDX-License-Identifier: MIT
// Pixel axes and close-ups of the --preview pictures, so that the author can read the coordinates
// of a pixel. Each function leaves its arguments unchanged. Thread: any.
#pragma once

#include <opencv2/core.hpp>

#include "common/geometry.hpp"

namespace hapticast::server {

/// Returns the part of a picture of size `picture` that shows the objects in `box` with a margin.
/// The part has the aspect ratio of the picture. Returns the whole picture if `box` is empty, or if
/// that part would be wider than half of the picture.
[[nodiscard]] cv::Rect selectCloseUp(const cv::Rect& box, const cv::Size& picture);

/// Returns the distance of two ticks, px: 1, 2 or 5 times a power of ten. `scale`: drawn px for
/// each px of the picture.
[[nodiscard]] int tickStep_px(double scale);

/// Returns the position of the pixel `at_px` in a drawing of `part`. `scale`: drawn px for each px
/// of the picture.
[[nodiscard]] cv::Point computePixelPlace(const cv::Point& at_px, const cv::Rect& part,
                                          double scale);

inline constexpr int kAxisLeft_px = 44;  ///< width of the axis of v
inline constexpr int kAxisTop_px = 22;   ///< height of the axis of u

/// Returns `drawn` with an axis of u above it, an axis of v on its left, and a light grid in it.
/// `drawn` shows `part` of a frame, whose pixels are `own_px` pixels of the clip's own pictures.
/// The numbers are pixels of the own pictures.
[[nodiscard]] cv::Mat drawAxes(const cv::Mat& drawn, const cv::Rect& part,
                               const Vec2& own_px = Vec2::Ones());

}  // namespace hapticast::server
