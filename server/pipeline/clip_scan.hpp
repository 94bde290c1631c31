// SPDX-License-Identifier: MIT
// The look through a recorded clip before it plays: what it tells people meanwhile, and that it can
// be broken off. What it finds is vision's. Thread: the pipeline's.
#pragma once

#include <atomic>
#include <functional>

#include "common/time.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// The share of the look that is done, 0..1: told after each frame, never where there is no look.
using ScanProgress = std::function<void(double share)>;

/// Lets vision look through the clip where it has to. Logs how far it is, at most every two
/// seconds; `progress` may be null. False where `stop` has broken it off.
bool scanClip(Vision& vision, RgbdSource& source, const MediaClock& clock,
              const std::atomic<bool>& stop, const ScanProgress& progress);

}  // namespace hapticast::server
