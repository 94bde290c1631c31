// SPDX-License-Identifier: MIT
// Loop seam test: decides whether objects continue where a looped clip begins again, or a new epoch
// has to start. Thread: any.
#pragma once

#include <vector>

#include "server/vision/motion/nominal_frame.hpp"
#include "server/vision/tracked_object.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns whether both frames show the same objects by id, all of them seen.
bool haveSameObjects(const std::vector<TrackedObject>& a, const std::vector<TrackedObject>& b);

/// Returns whether the same objects are unchanged since the frame before. Pose and relief together
/// may change the force by at most the error budget.
bool nothingMoved(const std::vector<TrackedObject>& before, const std::vector<TrackedObject>& now,
                  const NominalFrame& nominal, const VisionSettings& settings);

}  // namespace hapticast::server
