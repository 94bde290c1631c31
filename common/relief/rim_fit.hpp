// SPDX-License-Identifier: MIT
// The local fit that continues a relief beyond the rim of its mask. Used to prepare height fields,
// off the loop; any thread.
#pragma once

#include <cstdint>
#include <vector>

namespace hapticast {

/// A quadratic about one pixel, from the masked heights around it.
class RimFit {
 public:
  /// Gaussian weights of 2.5 px over the masked pixels within 5 px of (u, v). A plane is met
  /// exactly; curvature is held back by a small ridge where the pixels do not show it (thin masks).
  /// Requires mask(u, v) = 1.
  RimFit(const std::vector<float>& height_mm, const std::vector<std::uint8_t>& mask, int width,
         int height, int u, int v);

  /// Height at (du, dv) px from the pixel: the quadratic for 4 px, from there straight on to 12 px,
  /// from there held; never farther than 2 mm from the weighted mean around the pixel.
  [[nodiscard]] double at(double du, double dv) const;

 private:
  double mean_mm_ = 0.0;
  double constant_ = 0.0;
  double slope_u_ = 0.0, slope_v_ = 0.0;
  double bend_uu_ = 0.0, bend_uv_ = 0.0, bend_vv_ = 0.0;
};

}  // namespace hapticast
