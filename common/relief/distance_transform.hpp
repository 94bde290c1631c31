// SPDX-License-Identifier: MIT
// Exact Euclidean distance transform in linear time (Felzenszwalb and Huttenlocher, Distance
// Transforms of Sampled Functions, 2012). It finds the nearest marked pixel of each pixel. It
// serves to prepare height fields, outside the haptic loop. Thread: any.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast {

/// For each pixel, row by row, the nearest marked pixel.
struct NearestPixel {
  /// Distance to that pixel, between the pixels' centres. It is 0 on a marked pixel, and infinity
  /// if no pixel is marked.
  std::vector<float> distance_mm;
  /// Index (row * width + column) of that pixel. It is -1 if no pixel is marked.
  std::vector<std::int32_t> nearest;
};

/// Returns for every pixel the nearest pixel whose value in `mask` is `marked` (0 or 1). `mask` has
/// `width` x `height` pixels, row by row. `mm_per_px` is the width and height of a pixel, which may
/// differ.
///
/// The time is linear in the number of pixels. The function processes the columns first. Along each
/// row it then uses the lower envelope of parabolas. Requires mask.size() == width * height, both
/// above 0.
NearestPixel findNearestPixel(const std::vector<std::uint8_t>& mask, int width, int height,
                              std::uint8_t marked, const Vec2& mm_per_px);
/// Returns only the distances of findNearestPixel().
std::vector<float> distanceTo(const std::vector<std::uint8_t>& mask, int width, int height,
                              std::uint8_t marked, const Vec2& mm_per_px);

/// Smooths `distance_mm` in place. `distance_mm` has the signed distance of each pixel to the edge
/// of a mask, row by row, in mm, positive inside.
///
/// A Gaussian of 1.8 px smooths all distances. Within 4 px of the edge, the values of a fitted
/// quadratic replace the smoothed distances. Each fit uses the distances on a line along the edge,
/// which extends 8 to 24 px to either side. The line is the longest one on which fit and distances
/// differ by at most about half a pixel (Lepski's choice of a bandwidth).
///
/// The caller uses the result as the coefficients of a uniform cubic B-spline. The edge of a circle
/// then has its true radius. Smoothing is necessary because the proxy contacts the edge as a wall.
/// Requires distance_mm.size() == width * height, both above 0, and finite values. Call it outside
/// the haptic loop. Thread: any.
void smoothEdgeDistance(std::vector<float>& distance_mm, int width, int height,
                        const Vec2& mm_per_px);

}  // namespace hapticast
