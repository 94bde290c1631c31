// SPDX-License-Identifier: MIT
// A point well inside a mask, for whoever wants to touch an object in its middle. Off the loop.
#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry.hpp"

namespace hapticast {

/// Centre (px, image frame) of the pixel of `mask` (row-major over `rect`, 1 inside) farthest from
/// all pixels outside, the first of equals; the rectangle's surroundings are outside. By chamfer
/// distances, 8 % off at most; time linear in the rectangle. (0, 0) when nothing is inside or the
/// sizes do not match.
Vec2 deepestPoint(const PixelRect& rect, const std::vector<std::uint8_t>& mask);

}  // namespace hapticast
