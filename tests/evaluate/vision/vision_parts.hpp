// SPDX-License-Identifier: MIT
// The parts of the topic `vision` (vision.cpp), each in a file of its own.
#pragma once

#include "tests/evaluate/report.hpp"
#include "tests/evaluate/vision/vision_run.hpp"

namespace hapticast::evaluate {

/// Stages `relief` (rms against the true surface, by the exact mask) and, of a scene at rest,
/// `rest` (force noise on a finger that does not move, by the segmenter's mask).
void measureReliefs(const Clip& clip, Report& report);

/// Force on a finger that stays where it is, 2 mm below the mean surface of the frames `from` ..
/// `to` (heights over the whole picture, NaN outside): rms over time of what changes, pooled over
/// the pixels that are always on the object.
double forceNoise_N(const std::vector<cv::Mat>& heights_mm, std::size_t from, std::size_t to,
                    double mm_per_px);

/// The real clips, where they are: objects lost, change of the mask from frame to frame with the
/// motion removed, and a contact sheet of each object.
void measureRealClips(const Options& options, Report& report);

}  // namespace hapticast::evaluate
