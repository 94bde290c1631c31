// SPDX-License-Identifier: MIT
// The parts of the topic `vision` (vision.cpp), each in a file of its own.
#pragma once

#include "tests/evaluate/report.hpp"
#include "tests/evaluate/vision/vision_run.hpp"

namespace hapticast::evaluate {

/// Stages `relief` (rms against the true surface, by the exact mask) and, of a scene at rest,
/// `rest` (force noise on a finger that does not move, by the segmenter's mask).
void measureReliefs(const Clip& clip, Report& report);

/// The real clips, where they are: objects lost, change of the mask from frame to frame with the
/// motion removed, and a contact sheet of each object.
void measureRealClips(const Options& options, Report& report);

}  // namespace hapticast::evaluate
