// SPDX-License-Identifier: MIT
// Height field: a relief that is prepared for contact. Its heights continue beyond the mask. It
// also has the signed distance of each point to the mask's edge.
//
// It is prepared outside the haptic loop. After that it does not change, and the 1 kHz loop samples
// it. Thread: any.
#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast {

/// Height and its gradient in the nominal frame (mm and mm/mm; x right, y up).
struct SurfaceSample {
  double height_mm = 0.0;
  Vec2 gradient = Vec2::Zero();
};

/// Height, gradient and second derivatives (1/mm).
struct CurvedSample : SurfaceSample {
  double bend_xx = 0.0;
  double bend_xy = 0.0;
  double bend_yy = 0.0;
};

/// Signed distance to the edge of a mask (mm, positive inside) and its gradient (mm/mm).
struct EdgeSample {
  double distance_mm = 0.0;
  Vec2 gradient = Vec2::Zero();
};

/// The prepared relief of one layer.
class HeightField {
 public:
  HeightField() = default;

  /// Returns the height field of `relief`. Its heights continue kMargin_px beyond the mask by local
  /// fits (rim_fit.hpp). So depths beside the object do not affect samples near the edge of the
  /// mask.
  ///
  /// The field also has the smoothed signed distance to the mask's edge (distance_transform.hpp).
  /// The proxy contacts that edge as a wall. The time is linear in the number of pixels. Requires a
  /// valid relief (matching sizes, finite heights). The function may allocate, so the haptic loop
  /// must not call it.
  static HeightField prepare(const Relief& relief, const Workspace& workspace);
  /// Returns the height field of `relief` by the thesis's method: the height outside the mask is 0.
  static HeightField prepareThesis(const Relief& relief, const Workspace& workspace);

  /// Returns true if the pixel at `image_px` belongs to the object.
  [[nodiscard]] bool inside(const Vec2& image_px) const noexcept;
  /// Returns the height by bilinear interpolation. The gradient is that of the Sobel operator (Eq.
  /// 11-12), also with bilinear interpolation. Both are exact to about 1e-5 mm (single precision).
  ///
  /// Outside the prepared rectangle the result is the nearest prepared value. Any `image_px` is
  /// valid, and a NaN counts as the far left or top. Requires a field that is not empty.
  [[nodiscard]] SurfaceSample bilinear(const Vec2& image_px) const noexcept;
  /// Returns height, gradient and second derivatives of a uniform cubic B-spline that has the
  /// heights as coefficients. Otherwise it is like bilinear().
  [[nodiscard]] CurvedSample spline(const Vec2& image_px) const noexcept;
  /// Returns the signed distance to the mask's edge, and the gradient of the distance. Beyond
  /// +-kMargin_px the distance is constant. Both values are those of a cubic B-spline of the
  /// smoothed distances. Any `image_px` is valid, as for bilinear(). Requires a field that is not
  /// empty.
  [[nodiscard]] EdgeSample edge(const Vec2& image_px) const noexcept;
  /// Returns an upper bound of the height that spline() returns, mm.
  [[nodiscard]] double highest_mm() const noexcept { return highest_mm_; }

  /// Returns the centre of the pixel in the mask that is farthest from the mask's edge, px. Returns
  /// (0, 0) if the field is empty.
  [[nodiscard]] const Vec2& deepestPoint_px() const noexcept { return deepest_px_; }
  /// Returns the height at deepestPoint_px(), mm.
  [[nodiscard]] double deepestPointHeight_mm() const noexcept { return deepest_height_mm_; }

  [[nodiscard]] const PixelRect& rect() const noexcept { return rect_; }  ///< the mask's rectangle
  [[nodiscard]] bool empty() const noexcept { return height_mm_.empty(); }

  /// Returns the bytes of the prepared values. A full-HD relief has 19 MB.
  [[nodiscard]] std::size_t bytes() const noexcept {
    return sizeof(float) * (height_mm_.size() + edge_mm_.size()) + mask_.size();
  }

  static constexpr int kMargin_px = 12;  ///< width of the continued heights beyond the mask, px

 private:
  /// Returns a field with the heights inside the mask, and zero elsewhere. Returns an empty field
  /// if the sizes do not match.
  static HeightField makePadded(const Relief& relief, const Workspace& workspace);
  /// Computes the edge distances, the deepest point and the largest height. If `continued` is true,
  /// it also computes the heights beyond the mask.
  void complete(bool continued);

  PixelRect rect_;      // of the relief
  PixelRect prepared_;  // rect_ grown by kMargin_px on all sides (may extend beyond the picture)
  // Precomputed for sampling.
  Vec2 first_px_ = Vec2::Zero();  // centre of the first pixel
  Vec2 size_px_ = Vec2::Zero();
  Vec2 last_cell_ = Vec2::Zero();  // last point with 4 x 4 pixels around it, from first_px_
  Vec2 mm_per_px_ = Vec2::Ones();
  Vec2 px_per_mm_ = Vec2::Ones();
  Vec2 deepest_px_ = Vec2::Zero();  // in the mask
  double deepest_height_mm_ = 0.0;
  double highest_mm_ = 0.0;
  std::vector<float> height_mm_;    // over prepared_
  std::vector<float> edge_mm_;      // over prepared_
  std::vector<std::uint8_t> mask_;  // over prepared_
};

}  // namespace hapticast
