// SPDX-License-Identifier: MIT
// Local quadratic regression at the rim of a mask, which continues a relief beyond the rim.
// Prepares height fields, off the haptic loop. Thread: any.
#pragma once

#include <cstdint>
#include <vector>

namespace hapticast {

/// A quadratic about one pixel, fitted to the masked heights around it.
class RimFit {
 public:
  /// Fits with Gaussian weights of 2.5 px over the masked pixels within 5 px of (u, v). Exact for
  /// planes. A small ridge suppresses curvature that the pixels do not determine (thin masks).
  /// Requires mask(u, v) = 1.
  RimFit(const std::vector<float>& height_mm, const std::vector<std::uint8_t>& mask, int width,
         int height, int u, int v);

  /// Returns the height at (du, dv) px from the pixel, mm: the quadratic up to 4 px, its tangent up
  /// to 12 px, then constant. At most 2 mm from the weighted mean around the pixel.
  [[nodiscard]] double at(double du, double dv) const;

 private:
  double mean_mm_ = 0.0;
  double constant_ = 0.0;
  double slope_u_ = 0.0, slope_v_ = 0.0;
  double bend_uu_ = 0.0, bend_uv_ = 0.0, bend_vv_ = 0.0;
};

}  // namespace hapticast
