// SPDX-License-Identifier: MIT
// Candidates for the first mask, from which an author picks one (--object U,V#2). Thread: main.
#pragma once

#include <vector>

#include "server/preview/preview_frame.hpp"
#include "server/source/rgbd_source.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Returns the first frame with each candidate for the object of the first --object point, the best
/// one first. Rewinds `source`. Returns an empty vector if the source is live or has masks, or if
/// there is no such point. Throws SourceError.
[[nodiscard]] std::vector<PreviewFrame> listCandidates(RgbdSource& source,
                                                       const VisionSettings& settings);

}  // namespace hapticast::server
