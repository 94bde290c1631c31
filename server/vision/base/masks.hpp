// SPDX-License-Identifier: MIT
// Functions for masks (CV_8UC1, 0/255): bounding boxes, centroids, erosion, dilation, holes,
// connected pieces. No function changes its arguments. Thread: any.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Returns the bounding rectangle of the non-zero pixels of `mask`, enlarged by `margin_px` on each
/// side and clipped to the picture. The rectangle is empty if all pixels are zero.
cv::Rect findBoxAround(const cv::Mat& mask, int margin_px);
/// Returns `rect`, enlarged by `margin_px` on each side and clipped to a picture of `size`.
cv::Rect growRect(const cv::Rect& rect, int margin_px, const cv::Size& size);

/// Returns how far two masks of one size coincide: their intersection over their union, 0..1.
/// Returns 0 if both are empty.
double computeOverlap(const cv::Mat& a, const cv::Mat& b);

/// Returns the centroid of a mask in the picture, px (pixel centres lie at whole numbers). Returns
/// (0, 0) for an empty mask. `moments`: cv::moments() of the mask. `corner`: position of the mask's
/// first pixel in the picture.
cv::Point2d computeCentroid(const cv::Moments& moments, const cv::Point& corner);

/// Return `mask`, eroded or dilated by a disc of `radius_px`. Pixels beyond the picture's border
/// have no influence on the result.
cv::Mat erodeBy(const cv::Mat& mask, int radius_px);
cv::Mat dilateBy(const cv::Mat& mask, int radius_px);

/// Returns `mask` with its holes of less than `largest_px` pixels filled.
cv::Mat fillHolesOf(const cv::Mat& mask, int largest_px);

/// Connected pieces of a mask. A pixel is connected to its 4 neighbours.
struct Pieces {
  cv::Mat labels;             ///< CV_32S: 1 and above in the pieces, 0 outside the mask
  std::vector<int> areas_px;  ///< pixels of each label; 0 for the label 0
  /// Returns the label of the largest piece, or 0 if there are none.
  [[nodiscard]] int largest() const;
};
/// Returns the pieces of `mask`.
Pieces findPieces(const cv::Mat& mask);
/// Returns the piece of `mask` that contains the pixel `at`. All pixels are 0 if `at` is not in
/// `mask`.
cv::Mat findPiece(const cv::Mat& mask, const cv::Point& at);
/// Returns whether `at` is a pixel of `mask`.
bool contains(const cv::Mat& mask, const cv::Point& at);
/// Returns the pixel of `mask` that is farthest from all pixels outside it. The picture's border
/// counts as outside.
cv::Point findDeepestPoint(const cv::Mat& mask);
/// Returns the median of the measured depths where `mask` is not 0, mm, or 0 if none was measured.
/// It uses only every `step`-th pixel of every `step`-th row.
double medianDepth(const cv::Mat& depth, const cv::Mat& mask, int step);

}  // namespace hapticast::server
