// SPDX-License-Identifier: MIT
// What becomes of objects where a clip begins again. Thread: any; values.
#pragma once

#include <vector>

#include "server/vision/motion/nominal_frame.hpp"
#include "server/vision/tracked_object.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Whether both frames show the same objects, by id, all of them seen.
bool haveSameObjects(const std::vector<TrackedObject>& a, const std::vector<TrackedObject>& b);

/// Whether the same objects are where they were in the frame before, and feel as they did: pose and
/// relief together change the force by the error budget at most.
bool nothingMoved(const std::vector<TrackedObject>& before, const std::vector<TrackedObject>& now,
                  const NominalFrame& nominal, const VisionSettings& settings);

}  // namespace hapticast::server
