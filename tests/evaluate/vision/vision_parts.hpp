// SPDX-License-Identifier: MIT
// The parts of the topic `vision` (vision.cpp), each in a file of its own.
#pragma once

#include "tests/evaluate/report.hpp"
#include "tests/evaluate/vision/vision_run.hpp"

namespace hapticast::evaluate {

inline constexpr double kStiffness_N_mm = 0.5;
inline constexpr std::size_t kSettled = 24;  ///< frames: what is held is held by then

/// Every frame's relief over the whole picture; NaN outside the mask.
struct Reliefs {
  std::vector<cv::Mat> height_mm;
  server::DepthRange range;
  double time_us = 0.0;  ///< per frame, of enhance
};
/// Runs the clip through Tracker, so that whatever it does over time is in the result. The object
/// is given by its true centroid in the first frame.
Reliefs reliefsOf(const Clip& clip, server::SegmentMode mode, Method method);

/// Real clips against masks drawn by hand: one click in the first frame, and the first mask at each
/// drawn frame.
void measureKeyMasks(Report& report);

/// Depth with the errors of an estimator (scale and shift 1 %, edges of 15 px, a delay of 2
/// frames): error of the static force, noise at rest, false impacts.
void measureEstimated(Report& report);

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
