// SPDX-License-Identifier: MIT
// The parts of the topic `figures`.
#pragma once

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// Figure 2: frame, depth, mask and enhanced depth.
void drawPictures(const Options& options, Report& report);
/// Figure 5: slice of the ball with the static force.
void drawSlice(const Options& options, Report& report);
/// Figures 6 and 7: static and total force, the ball moving across and towards the viewer, the
/// cursor still and accelerating.
void drawMotions(const Options& options, Report& report);
/// Figure 9: static and total force in x and y over time, on a real clip.
void drawRealClip(const Options& options, Report& report);

}  // namespace hapticast::evaluate
