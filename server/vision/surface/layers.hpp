// SPDX-License-Identifier: MIT
// Layer decomposition: splits an object at depth steps inside its mask (for example, a hand in
// front of a body). Each layer is a relief of its own, so that a gap does not become a slope.
// Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

inline constexpr int kMaxLayers = 4;  ///< largest number of layers of an object
inline constexpr DepthRange kAllDepths{0.0, 1e9};

/// Layers of an object.
struct Layers {
  int count = 1;
  /// CV_8UC1 over the surface's box: 0 outside, n + 1 in layer n; empty for one layer.
  cv::Mat labels;
};

/// Splits `surface` into the pieces whose measured depth steps by more than `step_mm` (working
/// depth) along their common border. Returns at most kMaxLayers layers.
/// A piece behind another one is a layer behind it; pieces that do not touch share a layer. Pieces
/// of less than 100 px or 2 % of the object join their neighbours.
/// `mapped_range`: depths that map to different heights. Depths beyond it clamp to its ends, so a
/// step there does not count.
Layers findLayers(const Surface& surface, double step_mm,
                  const DepthRange& mapped_range = kAllDepths);

}  // namespace hapticast::server
