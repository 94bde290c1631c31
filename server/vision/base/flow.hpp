// SPDX-License-Identifier: MIT
// How an object moved in the picture from the last frame to this one: pyramidal Lucas-Kanade on the
// segmented texture. Shared by segment (carries the mask) and motion. Coordinates: OpenCV's, pixel
// centres at whole numbers.
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// In boxes of more pixels every second one is enough, for corners and for means. Chosen.
inline constexpr int kDense_px = 40000;

/// Points of one picture and where they were found again in the next one.
struct PointTracks {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
};

struct ObjectFlow {
  cv::Matx23d similarity{1, 0, 0, 0, 1, 0};  ///< last px -> this px
  bool reliable = false;                     ///< the shift is measured; else it is the guess
  bool rotation_reliable = false;            ///< scale and rotation are measured too
  bool isStatic = false;  ///< it is at rest and is not looked at: its mask is the last one
  PointTracks tracks;     ///< on the object, those that agree with the similarity

  [[nodiscard]] cv::Point2d warp(const cv::Point2d& point) const;
  [[nodiscard]] double scale() const;
  /// Rotation in the picture, rad, from +u towards +v (clockwise as seen).
  [[nodiscard]] double rotation_rad() const;
};
using Flows = std::map<std::uint32_t, ObjectFlow>;  ///< by object id

/// Corners of `mask` (0 / 255) in the last picture followed into this one, forward and backward (<
/// 1 px), and the similarity most of them agree on (RANSAC, 2 px); a median shift where scale or
/// count make it doubtful. `guess_px` starts the search. Pictures CV_8UC1 of one size.
ObjectFlow trackObject(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& mask,
                       const cv::Vec2d& guess_px);

/// Follows `points` of the last picture into this one, forward and backward (< 1 px); each is
/// looked for first where `guesses` (of the same length) says. Those not found again are left out.
PointTracks trackPoints(const cv::Mat& last_gray, const cv::Mat& gray,
                        const std::vector<cv::Point2f>& points, std::vector<cv::Point2f> guesses);

/// `image`, given over `from_box` of the last picture, carried into `to_box` of this one; 0 where
/// it was not.
cv::Mat warpImage(const cv::Mat& image, const cv::Rect& from_box, const cv::Rect& to_box,
                  const cv::Matx23d& similarity, int interpolation);

/// A similarity as a 3 x 3 matrix, so that several can be joined by multiplication.
cv::Matx33d homogeneous(const cv::Matx23d& similarity);

}  // namespace hapticast::server
