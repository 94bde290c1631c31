// SPDX-License-Identifier: MIT
// Pinhole camera model and the depth range of a clip. Plain values without OpenCV, so that code
// without OpenCV can use the ground truth of the synthetic scenes. Thread: any.
#pragma once

#include <cmath>
#include <numbers>

#include "common/geometry.hpp"

namespace hapticast::server {

/// Range of depths. If it is the mapped range, far_mm becomes height 0, and near_mm becomes the
/// largest height of the workspace (30 mm).
struct DepthRange {
  double near_mm = 0.0;
  double far_mm = 0.0;
};

/// Pinhole camera: u = fx X/Z + cx, v = fy Y/Z + cy, with X right, Y down, Z forward. The image
/// frame is that of common/geometry.hpp: the centre of pixel (i, j) is (i + 0.5, j + 0.5). So cx
/// and cy are half a pixel larger than in OpenCV's convention.
struct CameraModel {
  double fx_px = 0.0, fy_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  bool operator==(const CameraModel&) const = default;

  /// Returns a camera with square pixels and the principal point in the picture's middle.
  /// `fov_deg`: horizontal field of view, degrees.
  [[nodiscard]] static CameraModel ofFieldOfView(double fov_deg, double width_px,
                                                 double height_px) {
    const double focal_px = 0.5 * width_px / std::tan(fov_deg * std::numbers::pi / 360.0);
    return {focal_px, focal_px, 0.5 * width_px, 0.5 * height_px};
  }
  /// Returns the horizontal field of view of a picture `width_px` wide that is centred on the axis,
  /// degrees.
  [[nodiscard]] double degreesAcross(double width_px) const {
    return 360.0 / std::numbers::pi * std::atan(0.5 * width_px / fx_px);
  }

  /// Returns where the point `at_mm` of the camera frame appears in the picture, px. Requires Z !=
  /// 0.
  [[nodiscard]] Vec2 project(const Vec3& at_mm) const {
    return {fx_px * at_mm.x() / at_mm.z() + cx_px, fy_px * at_mm.y() / at_mm.z() + cy_px};
  }
  /// Returns the point with Z = 1 on the ray through (u_px, v_px). The product of this point and a
  /// depth is the ray's point at that depth.
  [[nodiscard]] Vec3 ray(double u_px, double v_px) const {
    return {(u_px - cx_px) / fx_px, (v_px - cy_px) / fy_px, 1.0};
  }
};

}  // namespace hapticast::server
