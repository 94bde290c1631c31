// SPDX-License-Identifier: MIT
// Validation of the author's points against their clip. Thread: any.
#pragma once

#include "server/source/rgbd_source.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns `settings` without the points after the end of the clip and without contradictory points
/// (positive and negative at one place and time). Logs one line for each. A live source has no end.
[[nodiscard]] VisionSettings dropInvalidPoints(VisionSettings settings, const SourceInfo& info);

}  // namespace hapticast::server
