// SPDX-License-Identifier: MIT
// Which of the masks that a click may mean is the one that a person would have meant. Done once per
// object, some 0.3 s. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "server/vision/segment/follow/tracked_mask.hpp"

namespace hapticast::server {

struct ChosenStart {
  std::optional<TrackedMask> object;  ///< without an id yet; none: there is nothing
  const char* why_not = nullptr;
  std::vector<Plane> planes;  ///< of the scene, without those that go through the object
};

/// `point` and `not_points`: px of the picture.
ChosenStart selectInitialMask(const FrameImages& images, const SceneContext& scene,
                              const cv::Point& point, const std::vector<cv::Point>& not_points);

}  // namespace hapticast::server
