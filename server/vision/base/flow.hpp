// SPDX-License-Identifier: MIT
// Pyramidal Lucas-Kanade optical flow (Lucas and Kanade 1981, Bouguet 2001) of an object from the
// last frame to this frame. It tracks Shi-Tomasi corners of the object's texture. RANSAC fits a
// similarity (shift, rotation and scale) to the tracks. The segmenter moves masks with this
// similarity, and the motion measurement starts from it. Coordinates are those of OpenCV: pixel
// centres lie at whole numbers. Thread: any.
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

namespace hapticast::server {

/// Largest area of an object's bounding box of which every pixel is used, px. In a larger box, the
/// search for corners and means use only every second pixel and row. The value is a choice.
inline constexpr int kDense_px = 40000;

/// Points of one picture and the positions of the same points in the next picture, px. Both lists
/// have one length: from[i] moved to to[i].
struct PointTracks {
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
};

/// Motion of an object in the picture from the last frame to this frame.
struct ObjectFlow {
  /// Maps px of the last picture to px of this picture.
  cv::Matx23d similarity = cv::Matx23d::eye();
  bool reliable = false;           ///< true: the shift was measured; false: it is only a guess
  bool rotation_reliable = false;  ///< true: scale and rotation were measured too
  bool isStatic = false;  ///< the object rests: its mask is the last mask, nothing was measured
  PointTracks tracks;     ///< points on the object whose motion agrees with the similarity

  /// Maps a point of the last picture to this picture, px.
  [[nodiscard]] cv::Point2d warp(const cv::Point2d& point) const;
  /// Returns by which factor the object grew in the picture (1: unchanged).
  [[nodiscard]] double scale() const;
  /// Returns the object's rotation in the picture, rad, from +u towards +v (clockwise as
  /// displayed).
  [[nodiscard]] double rotation_rad() const;
};
using Flows = std::map<std::uint32_t, ObjectFlow>;  ///< flow of each object, by object id

/// Measures the motion of an object from the last picture to this picture. Tracks corners inside
/// `mask` (CV_8UC1, 0/255) as trackPoints() does, and fits a similarity to the tracks by RANSAC. An
/// inlier is a corner within 2 px of the fit. If there are too few corners, or if the scale is
/// implausible, the result is only their median shift. With fewer than three corners the result is
/// the shift `guess_px`. `mask` belongs to the last picture. `guess_px`: expected shift of the
/// object, at which the search starts. Both pictures are CV_8UC1 of one size.
ObjectFlow trackObject(const cv::Mat& last_gray, const cv::Mat& gray, const cv::Mat& mask,
                       const cv::Vec2d& guess_px);

/// Finds `points` (px) of the last picture in this picture. Returns the points that were found,
/// with their new positions, and omits all other points. Each found point is also tracked back into
/// the last picture. A point counts as found only if this second track ends less than 1 px from its
/// start. `guesses` has the expected position of each point in this picture, and the same length as
/// `points`. Both pictures are CV_8UC1 of one size.
PointTracks trackPoints(const cv::Mat& last_gray, const cv::Mat& gray,
                        const std::vector<cv::Point2f>& points, std::vector<cv::Point2f> guesses);

/// Moves `image` by `similarity`, which maps px of the last picture to px of this picture. `image`
/// covers `from_box` of the last picture, and the result covers `to_box` of this picture. Pixels
/// without a source are 0. `interpolation`: one of OpenCV's interpolation flags.
cv::Mat warpImage(const cv::Mat& image, const cv::Rect& from_box, const cv::Rect& to_box,
                  const cv::Matx23d& similarity, int interpolation);

/// Returns `similarity` as a 3 x 3 matrix, so that similarities can be multiplied.
cv::Matx33d homogeneous(const cv::Matx23d& similarity);

}  // namespace hapticast::server
