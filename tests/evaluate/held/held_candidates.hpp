// SPDX-License-Identifier: MIT
// The candidates of a click beside the one that vision chooses. Thread: any; values.
#pragma once

#include "tests/evaluate/held/held_run.hpp"

namespace hapticast::evaluate::held {

/// Sums of the IoU over clicks: of the chosen candidates, and of the best ones among all that
/// vision computed itself.
struct CandidateScores {
  std::size_t clicks = 0;
  double chosen = 0.0, best = 0.0;

  void add(const CandidateScores& other) {
    clicks += other.clicks;
    chosen += other.chosen;
    best += other.best;
  }
  [[nodiscard]] double mean(double sum) const { return clicks > 0 ? sum / double(clicks) : 0.0; }
};

/// Clicks on the middle of the object in the first frame, a third and two thirds of the clip.
CandidateScores compareCandidates(const Recording& recording);

}  // namespace hapticast::evaluate::held
