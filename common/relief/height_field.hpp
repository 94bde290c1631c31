// SPDX-License-Identifier: MIT
// A relief prepared for touch: heights continued beyond the mask, signed distance to the mask's
// edge. Built off the loop by whoever receives a frame; afterwards immutable and read by the 1 kHz
// loop.
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

/// The same with second derivatives (1/mm).
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

class HeightField {
 public:
  HeightField() = default;

  /// Continues the heights kMargin_px beyond the mask by local fits (rim_fit.hpp), so that a
  /// surface sampled near the rim is not pulled down by what lies beside the object, and finds the
  /// smoothed signed distance to the mask's edge (edge_distance.hpp), which the proxy feels as a
  /// wall. Takes time linear in the rectangle. Requires a validated relief (sizes match, finite
  /// heights). May allocate; not for the loop.
  static HeightField prepare(const Relief& relief, const Workspace& workspace);
  /// The thesis's way: zero outside the mask, nothing continued.
  static HeightField prepareThesis(const Relief& relief, const Workspace& workspace);

  /// Whether the pixel under `image_px` belongs to the object.
  [[nodiscard]] bool inside(const Vec2& image_px) const noexcept;
  /// Bilinear height and bilinearly interpolated Sobel gradient (Eq. 11-12), to about 1e-5 mm
  /// (single precision). Outside the prepared rectangle: the nearest prepared value. Any
  /// `image_px`; a NaN counts as the far left or top. Requires a field that is not empty.
  [[nodiscard]] SurfaceSample bilinear(const Vec2& image_px) const noexcept;
  /// Uniform cubic B-spline with the heights as coefficients; otherwise as bilinear().
  [[nodiscard]] CurvedSample spline(const Vec2& image_px) const noexcept;
  /// Signed distance to the mask's edge (a cubic B-spline of the smoothed field), clamped to
  /// +-kMargin_px. Coordinates and requirement as for bilinear().
  [[nodiscard]] EdgeSample edge(const Vec2& image_px) const noexcept;
  /// No spline() of this field is higher.
  [[nodiscard]] double highest_mm() const noexcept { return highest_mm_; }

  /// Centre of the pixel of the mask that is farthest from its edge, px, image frame; (0, 0) when
  /// empty.
  [[nodiscard]] const Vec2& deepestPoint_px() const noexcept { return deepest_px_; }
  /// Height of that pixel.
  [[nodiscard]] double deepestPointHeight_mm() const noexcept { return deepest_height_mm_; }

  [[nodiscard]] const PixelRect& rect() const noexcept { return rect_; }  ///< the mask's rectangle
  [[nodiscard]] bool empty() const noexcept { return height_mm_.empty(); }

  static constexpr int kMargin_px = 12;

 private:
  /// Heights inside the mask, zero elsewhere; empty when the sizes do not match.
  static HeightField padded(const Relief& relief, const Workspace& workspace);
  /// Edge distances and, if `continued`, the heights beyond the mask.
  void complete(bool continued);

  PixelRect rect_;      // of the relief
  PixelRect prepared_;  // rect_ grown by kMargin_px on all sides (may leave the picture)
  // The same in the numbers that sampling reckons with.
  Vec2 first_px_ = Vec2::Zero();  // centre of the first pixel
  Vec2 size_px_ = Vec2::Zero();
  Vec2 last_cell_ = Vec2::Zero();  // from there: the last point with 4 x 4 pixels around it
  Vec2 mm_per_px_ = Vec2::Ones();
  Vec2 px_per_mm_ = Vec2::Ones();
  Vec2 deepest_px_ = Vec2::Zero();  // of the mask
  double deepest_height_mm_ = 0.0;
  double highest_mm_ = 0.0;
  std::vector<float> height_mm_;    // over prepared_
  std::vector<float> edge_mm_;      // over prepared_
  std::vector<std::uint8_t> mask_;  // over prepared_
};

}  // namespace hapticast
