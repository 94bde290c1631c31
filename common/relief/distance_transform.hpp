// SPDX-License-Identifier: MIT
// Exact Euclidean distance to, and index of, the nearest marked pixel. Used to prepare height
// fields, off the loop; any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast {

struct NearestPixel {
  std::vector<float>
      distance_mm;  ///< between pixel centres, 0 on a marked pixel; infinity if there is none
  std::vector<std::int32_t>
      nearest;  ///< index (row * width + column) of that pixel; -1 if there is none
};

/// For every pixel of a row-major `mask` the nearest one whose value is `marked` (0 or 1). Pixels
/// may be oblong
/// (`mm_per_px`). Linear in the number of pixels: columns first, then the lower envelope of
/// parabolas along each row (Felzenszwalb and Huttenlocher, Distance Transforms of Sampled
/// Functions, 2012). Requires mask.size() == width * height, both > 0.
NearestPixel nearestPixel(const std::vector<std::uint8_t>& mask, int width, int height,
                          std::uint8_t marked, const Vec2& mm_per_px);
/// Its distances alone.
std::vector<float> distanceTo(const std::vector<std::uint8_t>& mask, int width, int height,
                              std::uint8_t marked, const Vec2& mm_per_px);

}  // namespace hapticast
