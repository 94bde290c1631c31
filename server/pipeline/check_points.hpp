// SPDX-License-Identifier: MIT
// The author's points against the clip that they are for. Thread: any.
#pragma once

#include "server/source/rgbd_source.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// `settings` without the points whose time is after the end of the clip, and without those that
/// are the object and none of it in one place at one time; a line in the log for each. A live
/// source has no end.
[[nodiscard]] VisionSettings dropInvalidPoints(VisionSettings settings, const SourceInfo& info);

}  // namespace hapticast::server
