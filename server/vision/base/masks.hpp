// SPDX-License-Identifier: MIT
// Masks (CV_8UC1, 0 / 255): their boxes, middles, margins and holes. Nothing here changes what it
// is given. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// The rectangle around all non-zero pixels of `mask`, grown by `margin_px` and cut to the picture;
/// empty if there are none.
cv::Rect boxAround(const cv::Mat& mask, int margin_px);
/// `rect` grown by `margin_px` on all sides and cut to a picture of this size.
cv::Rect grown(const cv::Rect& rect, int margin_px, const cv::Size& size);

/// Intersection over union of two masks of one size, 0..1; 0 where both are empty.
double computeOverlap(const cv::Mat& a, const cv::Mat& b);

/// The centroid of `moments` (of a mask whose first pixel is `corner` of the picture), px, pixel
/// centres at whole numbers; (0, 0) of an empty mask.
cv::Point2d computeCentroid(const cv::Moments& moments, const cv::Point& corner);

/// `mask` eroded or dilated by a disc of `radius_px`; what is beyond the picture counts as outside
/// for dilation and as inside for erosion.
cv::Mat erodedBy(const cv::Mat& mask, int radius_px);
cv::Mat dilatedBy(const cv::Mat& mask, int radius_px);

/// `mask` with its holes of less than `largest_px` pixels filled.
cv::Mat withoutHoles(const cv::Mat& mask, int largest_px);

}  // namespace hapticast::server
