// SPDX-License-Identifier: MIT
// Result of tracking for one object in one frame: surface, pose and residual motion. Thread: the
// one that runs Vision.
#pragma once

#include <cstdint>
#include <memory>

#include "server/vision/motion/grid.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// One object in one frame.
struct TrackedObject {
  std::uint32_t id = 0;
  bool seen = true;  ///< false: lost, stays at its last position
  Surface surface;
  ObjectPose pose;
  CellFlow cells;                 ///< residual motion; empty if the plan or the method omits it
  double quality = 1.0;           ///< of the tracking, 0..1
  double visible_fraction = 1.0;  ///< visible share of the area, 0..1
  /// Stages that are off; never null.
  std::shared_ptr<ScenePlan> plan = std::make_shared<ScenePlan>(PlanSettings{}, false);
  double held_share = 0.0;  ///< held share of the surface, 0..1; 1: all of it rests

  [[nodiscard]] bool atRest() const { return held_share >= 1.0; }
  /// Returns whether the tracking is good enough to measure motion; else the motion is
  /// extrapolated.
  [[nodiscard]] bool isWellTracked() const { return quality >= kGoodQuality; }

  static constexpr double kGoodQuality = 0.75;  ///< chosen: between 1 and a doubtful step's 0.7
};

}  // namespace hapticast::server
