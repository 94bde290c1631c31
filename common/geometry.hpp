// SPDX-License-Identifier: MIT
// Vectors, the workspace (image px <-> nominal mm, Eq. 7-10) and the device mapping (nominal mm <->
// device mm, a uniform similarity). Thread: any.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace hapticast {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

/// A rectangle of whole pixels; (u, v) is its top-left pixel.
struct PixelRect {
  int u = 0;
  int v = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
  /// Returns the area in pixels. Requires a non-empty rectangle.
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  bool operator==(const PixelRect&) const = default;
};

/// Nominal workspace that a stream announces. Nominal frame: origin at the picture's centre on the
/// plane of height 0; x right, y up, z towards the viewer; mm.
/// Image frame: u right, v down, px; pixel (i, j) covers [i, i+1) x [j, j+1). The picture is fitted
/// in with one scale for both axes.
struct Workspace {
  int width_px = 640;
  int height_px = 480;
  double width_mm = 160.0;
  double height_mm = 120.0;
  double depth_mm = 30.0;  ///< nominal z of the nearest mapped depth; heights are 0..depth_mm
  bool stretch = false;    ///< one scale for each axis, as in the thesis

  bool operator==(const Workspace&) const = default;

  /// Returns the width and height of one pixel in nominal mm.
  [[nodiscard]] Vec2 mmPerPixel() const noexcept;
  /// Returns the inverse of mmPerPixel(), with fewer divisions, for the haptic loop.
  [[nodiscard]] Vec2 pixelsPerMm() const noexcept {
    const Vec2 each(width_px / width_mm, height_px / height_mm);
    return stretch ? each : Vec2::Constant(each.maxCoeff());
  }
  /// Converts nominal mm to px. Eq. 7-10: u = (x - x_min)/s_x, v = (y_max - y)/s_y; the picture's
  /// top-left corner is (x_min, y_max).
  [[nodiscard]] Vec2 toImage(const Vec2& nominal_mm) const noexcept {
    return toImage(nominal_mm, pixelsPerMm());
  }
  /// Converts with a precomputed pixelsPerMm(), because divisions limit the speed of the loop.
  [[nodiscard]] Vec2 toImage(const Vec2& nominal_mm, const Vec2& px_per_mm) const noexcept {
    return {nominal_mm.x() * px_per_mm.x() + 0.5 * width_px,
            0.5 * height_px - nominal_mm.y() * px_per_mm.y()};
  }
  /// Converts px to nominal mm.
  [[nodiscard]] Vec2 toNominal(const Vec2& image_px) const noexcept;
};

/// Uniform similarity from nominal to device mm, so that slopes stay slopes:
/// device = scale * (nominal - centre).
struct DeviceMapping {
  double scale = 1.0;
  Vec3 centre_nominal_mm = Vec3::Zero();

  /// Returns the largest mapping of width x height x 70 nominal mm into a device workspace of
  /// `device_mm` about its origin. The 70 mm are 5 mm behind the picture, 30 mm of relief and 35 mm
  /// of air in front.
  static DeviceMapping fit(const Workspace& workspace, const Vec3& device_mm) noexcept;

  [[nodiscard]] Vec3 toDevice(const Vec3& nominal_mm) const noexcept;
  [[nodiscard]] Vec3 toNominal(const Vec3& device_mm) const noexcept;
};

}  // namespace hapticast
