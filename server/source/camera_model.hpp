// SPDX-License-Identifier: MIT
// The pinhole camera and the depth range of a clip. Plain values without OpenCV, so that the truth
// of the synthetic scenes can be used anywhere. Thread: any.
#pragma once

#include <cmath>
#include <numbers>

#include "common/geometry.hpp"

namespace hapticast::server {

/// Depths that are mapped to heights: far to 0, near to the workspace's depth (30 mm).
struct DepthRange {
  double near_mm = 0.0;
  double far_mm = 0.0;
};

/// Pinhole: u = fx X/Z + cx, v = fy Y/Z + cy with X right, Y down, Z forward. In the image frame of
/// common/geometry, where the centre of pixel (i, j) is (i + 0.5, j + 0.5); so cx, cy are half a
/// pixel larger than in OpenCV's convention.
struct CameraModel {
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;

  /// A camera with square pixels that looks through the middle of a picture `fov_deg` wide.
  [[nodiscard]] static CameraModel ofFieldOfView(double fov_deg, double width_px,
                                                 double height_px) {
    const double focal_px = 0.5 * width_px / std::tan(fov_deg * std::numbers::pi / 360.0);
    return {focal_px, focal_px, 0.5 * width_px, 0.5 * height_px};
  }
  /// How wide a picture of so many pixels is, as if its middle were on the axis.
  [[nodiscard]] double degreesAcross(double width_px) const {
    return 360.0 / std::numbers::pi * std::atan(0.5 * width_px / fx_px);
  }

  /// Where a point of the camera's frame, mm, is seen: px. Z must not be 0.
  [[nodiscard]] Vec2 project(const Vec3& at_mm) const {
    return {fx_px * at_mm.x() / at_mm.z() + cx_px, fy_px * at_mm.y() / at_mm.z() + cy_px};
  }
  /// The ray through a place of the picture, scaled to Z = 1: times the depth it is the point.
  [[nodiscard]] Vec3 ray(double u_px, double v_px) const {
    return {(u_px - cx_px) / fx_px, (v_px - cy_px) / fy_px, 1.0};
  }
};

}  // namespace hapticast::server
