// SPDX-License-Identifier: MIT
// The sent motion of a thing's surface, beside the exact motion of each of its pixels.
// Thread: any; values.
#pragma once

#include "tests/evaluate/held/held_run.hpp"

namespace hapticast::evaluate::held {

struct DeformScores {
  bool deforms = false;
  double share = -1.0;     ///< of the motion that no rigid one explains, the grid's share; median
  double flat = -1.0;      ///< the same in the picture alone
  double deep = -1.0;      ///< and in depth
  double looked = 0.0;     ///< share of the frames with a grid: of the deforming ones if it deforms
  double grid_mm_s = 0.0;  ///< rms of the grid over all frames, nominal
  double apart_mm_s = 0.0;  ///< rms of what no rigid motion explains, nominal
  double surface = -1.0;    ///< error of the whole sent motion, median over the rms of the truth
  double middle = -1.0;     ///< likewise, of the sent velocity of the place that is followed
  double median_ms = 0.0;
};
/// The run must have been one by the true masks of metric depth.
DeformScores deformScoresOf(const Recording& recording, const Run& run);

}  // namespace hapticast::evaluate::held
