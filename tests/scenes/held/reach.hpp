// SPDX-License-Identifier: MIT
// Which parts of a thing a ray may meet, and between where: so that a ray asks few formulas and
// begins near them. Thread: any; values.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "server/source/camera_model.hpp"
#include "tests/scenes/held/solid.hpp"

namespace hapticast::evaluate::held {

/// The pixels that a ball (camera's frame) may cover, also beyond the picture's border.
cv::Rect rectOf(const Ball& ball, const server::CameraModel& camera, const cv::Size& size);

class Reach {
 public:
  /// In a picture of `size`; `rect_of` a ball in the frame that the thing's pose leads to, also
  /// beyond the border.
  Reach(const Thing& thing, const cv::Size& size,
        const std::function<cv::Rect(const Ball&)>& rect_of);

  /// All that the thing may cover.
  [[nodiscard]] const cv::Rect& rect() const { return rect_; }
  /// The parts that may be in a row of pixels.
  [[nodiscard]] Parts inRow(int v) const;

  struct Span {
    double from = 1e12;
    double to = 0.0;
  };
  /// Of the candidates those that the ray (thing's frame) through a pixel of column `u` comes near,
  /// and the multiples of `direction` between which it does.
  Span onRay(const Parts& candidates, int u, const Vec3& origin, const Vec3& direction,
             Parts& out) const;

 private:
  struct Bound {
    cv::Rect rect;
    Vec3 begin_mm, end_mm;  // within radius_mm of the line between them
    double radius_mm = 0.0;
    std::vector<Ball> chain;  // or within one of these
  };
  [[nodiscard]] bool span(std::size_t part, const Vec3& origin, const Vec3& direction,
                          Span& out) const;

  const Thing& thing_;
  std::vector<Bound> bounds_;
  cv::Rect rect_;
};

}  // namespace hapticast::evaluate::held
