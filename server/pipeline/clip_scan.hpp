// SPDX-License-Identifier: MIT
// Scan of a recorded clip before its playback: vision processes all its frames and stores the
// results. It reports its progress and can be stopped. Thread: the pipeline's.
#pragma once

#include <functional>

#include "common/time.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/vision.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Converts the points and the camera of `settings` from pixels of the clip's own pictures to
/// pixels of the frames (SourceInfo::own_px). Removes invalid points, and logs one line for each of
/// them. Points after the end of the clip are invalid; a live source has no end. A positive and a
/// negative point less than 3 px apart at one time contradict each other, so both are invalid.
/// Returns the new settings. Thread: any.
[[nodiscard]] VisionSettings preparePoints(VisionSettings settings, const SourceInfo& info);

/// Function that scanClip() calls after each frame. `share`: completed share of the scan, 0..1.
/// Returns false to end the scan. It is never called if no scan is needed.
using ScanProgress = std::function<bool(double share)>;

/// Scans the clip if vision needs that. Returns false if `progress` ended the scan, otherwise true.
/// Throws SourceError. It logs the progress at most every two seconds. `progress` may be null.
bool scanClip(Vision& vision, RgbdSource& source, const MediaClock& clock,
              const ScanProgress& progress);

}  // namespace hapticast::server
