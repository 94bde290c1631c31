// SPDX-License-Identifier: MIT
// Morphology of masks (CV_8UC1, 0/255): bounding boxes, centroids, erosion, dilation, holes. No
// function changes its arguments. Thread: any.
#pragma once

#include <opencv2/core.hpp>

namespace hapticast::server {

/// Returns the bounding rectangle of the non-zero pixels of `mask`, grown by `margin_px` and
/// clipped to the picture. Empty if all pixels are zero.
cv::Rect boxAround(const cv::Mat& mask, int margin_px);
/// Returns `rect` grown by `margin_px` on all sides and clipped to a picture of `size`.
cv::Rect grown(const cv::Rect& rect, int margin_px, const cv::Size& size);

/// Returns the intersection over union of two masks of one size, 0..1; 0 if both are empty.
double computeOverlap(const cv::Mat& a, const cv::Mat& b);

/// Returns the centroid of `moments` in px, pixel centres at whole numbers. `corner`: position of
/// the mask's first pixel in the picture. (0, 0) for an empty mask.
cv::Point2d computeCentroid(const cv::Moments& moments, const cv::Point& corner);

/// Erodes or dilates `mask` with a disc of `radius_px`. Pixels beyond the picture count as outside
/// for dilation and as inside for erosion.
cv::Mat erodedBy(const cv::Mat& mask, int radius_px);
cv::Mat dilatedBy(const cv::Mat& mask, int radius_px);

/// Returns `mask` with its holes of less than `largest_px` pixels filled.
cv::Mat withoutHoles(const cv::Mat& mask, int largest_px);

}  // namespace hapticast::server
