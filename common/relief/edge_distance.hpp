// SPDX-License-Identifier: MIT
// Smoothing of a mask's signed distance field, whose edge the proxy contacts as a wall. Prepares
// height fields, off the haptic loop. Thread: any.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast {

/// Smooths the distances to the edge of a mask, row by row, in mm, positive inside. A Gaussian of
/// 1.8 px smooths all distances; within 4 px of the edge a quadratic along the edge replaces them.
/// The quadratic extends 8 to 24 px to either side, as far as it stays within about half a pixel of
/// the Gaussian's distances (Lepski's choice of a bandwidth).
/// As a uniform cubic B-spline of the result, a circle's edge has its true radius. Requires
/// distance_mm.size() == width * height, both > 0, and finite values.
void smoothEdgeDistance(std::vector<float>& distance_mm, int width, int height,
                        const Vec2& mm_per_px);

}  // namespace hapticast
