// SPDX-License-Identifier: MIT
// Local quadratic regression at the edge of a mask. It continues the heights of a relief beyond the
// mask. It serves to prepare height fields, outside the haptic loop. Thread: any.
#pragma once

#include <cstdint>
#include <vector>

namespace hapticast {

/// A quadratic function about one pixel, fitted to the heights inside the mask around it.
class RimFit {
 public:
  /// Fits the quadratic about the pixel (u, v), which must be inside the mask. The fit uses the
  /// pixels of the mask within 5 px. Their weights are a Gaussian with a standard deviation of 2.5
  /// px. The fit is exact for planes. In a thin mask the pixels may not determine the curvature. A
  /// small ridge term then keeps the curvature small.
  RimFit(const std::vector<float>& height_mm, const std::vector<std::uint8_t>& mask, int width,
         int height, int u, int v);

  /// Returns the height at the offset (du, dv) px from the pixel, mm. Up to a distance of 4 px it
  /// follows the quadratic. From 4 to 12 px it follows the tangent of the quadratic, and beyond 12
  /// px it is constant. It differs by at most 2 mm from the weighted mean of the heights around the
  /// pixel.
  [[nodiscard]] double at(double du, double dv) const;

 private:
  double mean_mm_ = 0.0;
  double constant_ = 0.0;
  double slope_u_ = 0.0, slope_v_ = 0.0;
  double bend_uu_ = 0.0, bend_uv_ = 0.0, bend_vv_ = 0.0;
};

}  // namespace hapticast
