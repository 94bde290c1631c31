// SPDX-License-Identifier: MIT
// Pyramidal Lucas-Kanade optical flow (Lucas and Kanade 1981, Bouguet 2001) of an object between
// the last frame and this frame, on Shi-Tomasi corners of its texture. RANSAC fits a similarity.
// The segmenter moves masks with this flow, and the motion measurement starts from it. Coordinates:
// OpenCV's, pixel centres at whole numbers. Thread: any.
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Larger boxes use every second pixel only, for corners and for means. Chosen.
inline constexpr int kDense_px = 40000;

/// Points of one picture and their positions in the next picture; equal lengths, px.
struct PointTracks {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
};

/// Motion of an object in the picture from the last frame to this frame.
struct ObjectFlow {
  cv::Matx23d similarity{1, 0, 0, 0, 1, 0};  ///< last px -> this px
  bool reliable = false;                     ///< the shift is measured; false: it is the guess
  bool rotation_reliable = false;            ///< scale and rotation are measured too
  bool isStatic = false;  ///< the object rests and was not measured: its mask is the last mask
  PointTracks tracks;     ///< tracks on the object that agree with the similarity

  /// Maps a point of the last picture to this picture, px.
  [[nodiscard]] cv::Point2d warp(const cv::Point2d& point) const;
  /// Returns the scale of the similarity (1: unchanged).
  [[nodiscard]] double scale() const;
  /// Returns the rotation in the picture, rad, from +u towards +v (clockwise in the picture).
  [[nodiscard]] double rotation_rad() const;
};
using Flows = std::map<std::uint32_t, ObjectFlow>;  ///< by object id

/// Tracks corners of `mask` (CV_8UC1, 0/255) from the last picture into this picture, forward and
/// backward (error below 1 px). Fits the similarity of most corners (RANSAC, 2 px).
/// Falls back to the median shift if there are too few corners or the scale is implausible.
/// `guess_px` is the initial shift. Pictures: CV_8UC1 of one size.
ObjectFlow trackObject(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& mask,
                       const cv::Vec2d& guess_px);

/// Tracks `points` of the last picture into this picture, forward and backward (error below 1 px).
/// The search for each point starts at its entry in `guesses` (same length). Omits lost points.
PointTracks trackPoints(const cv::Mat& last_gray, const cv::Mat& gray,
                        const std::vector<cv::Point2f>& points, std::vector<cv::Point2f> guesses);

/// Warps `image`, which covers `from_box` of the last picture, into `to_box` of this picture.
/// Pixels without a source are 0.
cv::Mat warpImage(const cv::Mat& image, const cv::Rect& from_box, const cv::Rect& to_box,
                  const cv::Matx23d& similarity, int interpolation);

/// Converts a similarity to a 3 x 3 matrix, so that similarities can be multiplied.
cv::Matx33d homogeneous(const cv::Matx23d& similarity);

}  // namespace hapticast::server
