// SPDX-License-Identifier: MIT
// Height field: a relief prepared for contact, with heights continued beyond the mask and the
// signed distance to the mask's edge.
// Prepared off the haptic loop, then immutable and sampled by the 1 kHz loop. Thread: any.
#pragma once

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

  /// Prepares `relief`: continues its heights kMargin_px beyond the mask by local fits
  /// (rim_fit.hpp), so that nothing beside the object affects samples near the rim.
  /// Computes the smoothed signed distance to the mask's edge (distance_transform.hpp), which the proxy
  /// contacts as a wall. Time is linear in the rectangle.
  /// Requires a validated relief (matching sizes, finite heights). May allocate; not for the haptic
  /// loop.
  static HeightField prepare(const Relief& relief, const Workspace& workspace);
  /// Prepares `relief` by the thesis's method: height 0 outside the mask, without continuation.
  static HeightField prepareThesis(const Relief& relief, const Workspace& workspace);

  /// Returns whether the pixel at `image_px` belongs to the object.
  [[nodiscard]] bool inside(const Vec2& image_px) const noexcept;
  /// Returns the bilinear height and the bilinearly interpolated Sobel gradient (Eq. 11-12), exact
  /// to about 1e-5 mm (single precision).
  /// Outside the prepared rectangle: the nearest prepared value. Accepts any `image_px`; a NaN
  /// counts as the far left or top. Requires a non-empty field.
  [[nodiscard]] SurfaceSample bilinear(const Vec2& image_px) const noexcept;
  /// Returns a uniform cubic B-spline with the heights as coefficients; otherwise like bilinear().
  [[nodiscard]] CurvedSample spline(const Vec2& image_px) const noexcept;
  /// Returns the signed distance to the mask's edge (a cubic B-spline of the smoothed field),
  /// clamped to +-kMargin_px. Coordinates and requirement: see bilinear().
  [[nodiscard]] EdgeSample edge(const Vec2& image_px) const noexcept;
  /// Returns an upper bound of spline() over the field, mm.
  [[nodiscard]] double highest_mm() const noexcept { return highest_mm_; }

  /// Returns the centre of the mask's pixel farthest from the edge, px, image frame; (0, 0) when
  /// empty.
  [[nodiscard]] const Vec2& deepestPoint_px() const noexcept { return deepest_px_; }
  /// Returns the height of that pixel, mm.
  [[nodiscard]] double deepestPointHeight_mm() const noexcept { return deepest_height_mm_; }

  [[nodiscard]] const PixelRect& rect() const noexcept { return rect_; }  ///< the mask's rectangle
  [[nodiscard]] bool empty() const noexcept { return height_mm_.empty(); }

  static constexpr int kMargin_px = 12;  ///< width of the continuation, px

 private:
  /// Returns heights inside the mask, zero elsewhere; empty if the sizes do not match.
  static HeightField padded(const Relief& relief, const Workspace& workspace);
  /// Computes edge distances and, if `continued`, the heights beyond the mask.
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
