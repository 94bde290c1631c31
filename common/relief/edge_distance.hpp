// SPDX-License-Identifier: MIT
// The signed distance to a mask's edge as the proxy feels it. Used to prepare height fields, off
// the loop; any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast {

/// Smooths distances to the edge of a mask, row-major, in mm, positive inside: by a Gaussian of
/// 1.8 px, and within 4 px of the edge by a quadratic along it, as far along (8 to 24 px to
/// either side) as the quadratic stays within about half a pixel of the Gaussian's distances. Read
/// as a uniform cubic B-spline, a circle's edge keeps its radius. Requires distance_mm.size() ==
/// width * height, both > 0, and all of it finite.
void smoothEdgeDistance(std::vector<float>& distance_mm, int width, int height,
                        const Vec2& mm_per_px);

}  // namespace hapticast
