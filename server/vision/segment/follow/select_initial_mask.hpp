// SPDX-License-Identifier: MIT
// Initial mask selection: scores the candidate masks of a point by objectness and selects the best.
// Runs once for each object, about 0.3 s. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "server/vision/segment/follow/tracked_mask.hpp"

namespace hapticast::server {

/// Result of the selection.
struct ChosenStart {
  std::optional<TrackedMask> object;  ///< without an id yet; nullopt: no object
  const char* why_not = nullptr;      ///< the cause if there is no object, else null
  std::vector<Plane> planes;          ///< planes of the scene without those through the object
};

/// Selects the mask of the object at `point`, without the objects at `not_points` (px of the
/// picture).
ChosenStart selectInitialMask(const FrameImages& images, const SceneContext& scene,
                              const cv::Point& point, const std::vector<cv::Point>& not_points);

}  // namespace hapticast::server
