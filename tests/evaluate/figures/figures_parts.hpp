// SPDX-License-Identifier: MIT
// The parts of the topic `figures`.
#pragma once

#include "tests/evaluate/report.hpp"

namespace hapticast::evaluate {

/// Figure 2: frame, depth, mask and enhanced depth.
void drawPictures(const Options& options);
/// Figure 5: slice of the ball with the static force.
void drawSlice(const Options& options, Report& report);
/// Figures 6 and 7: profile of static and total force over a slice of the ball. The ball moves
/// across and towards the viewer, the cursor is still and has a constant acceleration.
void drawMotions(const Options& options, Report& report);
/// Figure 9: static and total force in x and y over time, on a real clip.
void drawRealClip(const Options& options);

}  // namespace hapticast::evaluate
