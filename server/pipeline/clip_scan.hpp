// SPDX-License-Identifier: MIT
// Scan of a recorded clip before its playback, with progress reports and cancellation. Vision
// stores its results. Thread: the pipeline's.
#pragma once

#include <atomic>
#include <functional>

#include "common/time.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/vision.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

// Validation of the author's points against their clip. Thread: any.

/// Returns `settings` without the points after the end of the clip and without contradictory points
/// (positive and negative at one place and time). Logs one line for each. A live source has no end.
[[nodiscard]] VisionSettings dropInvalidPoints(VisionSettings settings, const SourceInfo& info);

/// Called with the completed share of the scan, 0..1, after each frame. Never called without a
/// scan.
using ScanProgress = std::function<void(double share)>;

/// Scans the clip if vision needs it. Logs the progress at most every two seconds. `progress` may
/// be null. Returns false if `stop` cancelled the scan. Throws SourceError.
bool scanClip(Vision& vision, RgbdSource& source, const MediaClock& clock,
              const std::atomic<bool>& stop, const ScanProgress& progress);

}  // namespace hapticast::server
