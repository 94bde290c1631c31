// SPDX-License-Identifier: MIT
// Exact Euclidean distance transform in linear time (Felzenszwalb and Huttenlocher, Distance
// Transforms of Sampled Functions, 2012). Prepares height fields, off the haptic loop. Thread: any.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast {

/// Nearest marked pixel of each pixel, row by row.
struct NearestPixel {
  /// Between pixel centres; 0 on a marked pixel, infinity if there is none.
  std::vector<float> distance_mm;
  /// Index (row * width + column) of the nearest marked pixel; -1 if there is none.
  std::vector<std::int32_t> nearest;
};

/// Finds for every pixel of a row-major `mask` the nearest pixel with the value `marked` (0 or 1).
/// `mm_per_px`: size of a pixel; pixels need not be square.
/// Time is linear in the number of pixels: columns first, then the lower envelope of parabolas
/// along each row. Requires mask.size() == width * height, both > 0.
NearestPixel nearestPixel(const std::vector<std::uint8_t>& mask, int width, int height,
                          std::uint8_t marked, const Vec2& mm_per_px);
/// Returns the distances only.
std::vector<float> distanceTo(const std::vector<std::uint8_t>& mask, int width, int height,
                              std::uint8_t marked, const Vec2& mm_per_px);

// Smoothing of a mask's signed distance field, whose edge the proxy contacts as a wall. Prepares
// height fields, off the haptic loop. Thread: any.

/// Smooths the distances to the edge of a mask, row by row, in mm, positive inside. A Gaussian of
/// 1.8 px smooths all distances; within 4 px of the edge a quadratic along the edge replaces them.
/// The quadratic extends 8 to 24 px to either side, as far as it stays within about half a pixel of
/// the Gaussian's distances (Lepski's choice of a bandwidth).
/// As a uniform cubic B-spline of the result, a circle's edge has its true radius. Requires
/// distance_mm.size() == width * height, both > 0, and finite values.
void smoothEdgeDistance(std::vector<float>& distance_mm, int width, int height,
                        const Vec2& mm_per_px);

}  // namespace hapticast
