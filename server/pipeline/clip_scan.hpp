// SPDX-License-Identifier: MIT
// Scan of a recorded clip before its playback, with progress reports and cancellation. Vision
// stores its results. Thread: the pipeline's.
#pragma once

#include <atomic>
#include <functional>

#include "common/time.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// Called with the completed share of the scan, 0..1, after each frame. Never called without a
/// scan.
using ScanProgress = std::function<void(double share)>;

/// Scans the clip if vision needs it. Logs the progress at most every two seconds. `progress` may
/// be null. Returns false if `stop` cancelled the scan. Throws SourceError.
bool scanClip(Vision& vision, RgbdSource& source, const MediaClock& clock,
              const std::atomic<bool>& stop, const ScanProgress& progress);

}  // namespace hapticast::server
