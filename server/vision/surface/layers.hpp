// SPDX-License-Identifier: MIT
// An object whose surface has a depth step inside (a hand before a body) is cut there: each layer
// is a relief of its own, so that no slope is felt where there is a gap. Thread: vision's.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

inline constexpr int kMaxLayers = 4;
inline constexpr DepthRange kAllDepths{0.0, 1e9};

/// Pieces of an object between depth steps.
struct Layers {
  int count = 1;
  cv::Mat labels;  ///< CV_8UC1 over the surface's box: 0 outside, n + 1 in layer n; empty with one
};

/// The pieces of `surface` whose measured depth steps by more than `step_mm` (working depth) along
/// their common border. What lies behind something is a layer behind it; pieces that do not touch
/// share one. Pieces of less than 100 px or 2 % of the object stay with their neighbours. At most
/// kMaxLayers.
/// `mapped_range`: depths that differ in height; what lies beyond is as high as its end, and no
/// step.
Layers findLayers(const Surface& surface, double step_mm,
                  const DepthRange& mapped_range = kAllDepths);

}  // namespace hapticast::server
