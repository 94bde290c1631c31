// SPDX-License-Identifier: MIT
// Vectors, the workspace, and the device mapping. The workspace converts between image px and
// nominal mm (Eq. 7-10). The device mapping converts between nominal mm and device mm, by one scale
// for all axes. Thread: any.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace hapticast {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

/// Returns `expression`, a vector, shortened to a length of at most `longest`. Real-time.
template <class Derived>
[[nodiscard]] typename Derived::PlainObject limitLength(
    const Eigen::MatrixBase<Derived>& expression, double longest) noexcept {
  typename Derived::PlainObject vector = expression;
  const double length = vector.norm();
  if (length > longest) vector *= longest / length;
  return vector;
}

/// A rectangle of whole pixels; (u, v) is its top-left pixel.
struct PixelRect {
  int u = 0;
  int v = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
  /// Returns the number of pixels. Requires a rectangle that is not empty.
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  bool operator==(const PixelRect&) const = default;
};

/// Nominal workspace of a stream. The server announces it. The nominal frame has its origin at the
/// picture's centre, on the plane of height 0. x points right, y up, and z towards the viewer; all
/// are in mm.
///
/// In the image frame u points right and v down, in px. Pixel (i, j) covers [i, i+1) x [j, j+1).
/// The picture fits into the workspace with one scale for both axes.
struct Workspace {
  int width_px = 640;
  int height_px = 480;
  double width_mm = 160.0;
  double height_mm = 120.0;
  double depth_mm = 30.0;  ///< largest height: nominal z of the near end of the mapped range
  bool stretch = false;    ///< true: each axis has its own scale, as in the thesis

  bool operator==(const Workspace&) const = default;

  /// Returns the width and height of one pixel in nominal mm.
  [[nodiscard]] Vec2 mmPerPixel() const noexcept;
  /// Returns the inverse of mmPerPixel(). It needs fewer divisions, for the haptic loop.
  [[nodiscard]] Vec2 pixelsPerMm() const noexcept {
    const Vec2 each(width_px / width_mm, height_px / height_mm);
    return stretch ? each : Vec2::Constant(each.maxCoeff());
  }
  /// Converts nominal mm to px by Eq. 7-10: u = (x - x_min)/s_x, v = (y_max - y)/s_y. (s_x, s_y) is
  /// mmPerPixel(). The picture's top-left corner is (x_min, y_max).
  [[nodiscard]] Vec2 toImage(const Vec2& nominal_mm) const noexcept {
    return toImage(nominal_mm, pixelsPerMm());
  }
  /// Converts nominal mm to px. `px_per_mm` is the result of pixelsPerMm(). It contains no
  /// division, because divisions would slow the haptic loop.
  [[nodiscard]] Vec2 toImage(const Vec2& nominal_mm, const Vec2& px_per_mm) const noexcept {
    return {nominal_mm.x() * px_per_mm.x() + 0.5 * width_px,
            0.5 * height_px - nominal_mm.y() * px_per_mm.y()};
  }
  /// Converts px to nominal mm.
  [[nodiscard]] Vec2 toNominal(const Vec2& image_px) const noexcept;
};

/// Conversion from nominal to device mm: device = scale * (nominal - centre). All axes have the
/// same scale, so that slopes do not change.
struct DeviceMapping {
  double scale = 1.0;
  Vec3 centre_nominal_mm = Vec3::Zero();

  /// Returns the mapping with the largest scale at which the nominal box fits into the device's
  /// workspace. The nominal box has the width and height of `workspace` and is 70 mm deep. The 70
  /// mm are 5 mm behind the picture, 30 mm of relief, and 35 mm of air in front of it. The device's
  /// workspace has the size `device_mm`, and its centre is the device's origin.
  static DeviceMapping fit(const Workspace& workspace, const Vec3& device_mm) noexcept;

  [[nodiscard]] Vec3 toDevice(const Vec3& nominal_mm) const noexcept;
  [[nodiscard]] Vec3 toNominal(const Vec3& device_mm) const noexcept;
};

}  // namespace hapticast
