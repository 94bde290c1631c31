// SPDX-License-Identifier: MIT
// Initial mask selection: computes candidate masks at the author's point, and selects the one that
// most probably covers one object. Runs once for each object and lasts about 0.3 s. Thread: the one
// that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "server/vision/segment/follow/tracked_mask.hpp"

namespace hapticast::server {

/// Result of the selection.
struct ChosenStart {
  std::optional<TrackedMask> object;  ///< the object, still without an id; nullopt: there is none
  const char* why_not = nullptr;      ///< the cause if there is no object, else null
  double score = 0.0;                 ///< objectness of the chosen candidate
  /// Planes of the scene, without those through the object.
  std::vector<Plane> planes{};
  /// Distinct candidates (IoU below 0.9 with each other), still without ids: the chosen one first,
  /// then by falling score.
  std::vector<TrackedMask> ranked{};
  /// One line for each candidate, with its score and the score's terms, for --explain.
  std::vector<std::string> explanation{};
};

/// Returns the object at `point` with its mask, or the cause if there is none. The mask excludes
/// the objects at `not_points`. All points are px of the picture.
ChosenStart selectInitialMask(const FrameImages& images, const SceneContext& scene,
                              const cv::Point& point, const std::vector<cv::Point>& not_points);

/// Returns the object to use if the author gives no point. It runs selectInitialMask() at each
/// object proposal, and selects the highest sum of the score and a rating of the place. The rating
/// prefers a near object, a held one, and one near the middle of the picture. The end of a limb
/// counts only if its score is high enough for an object.
ChosenStart selectAutomatically(const FrameImages& images, const SceneContext& scene,
                                const std::vector<cv::Point>& not_points);

}  // namespace hapticast::server
