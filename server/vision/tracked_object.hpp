// SPDX-License-Identifier: MIT
// What tracking tells of one object in one frame: its surface, where it is and how it moves.
// Thread: vision's.
#pragma once

#include <cstdint>
#include <memory>

#include "server/vision/motion/grid.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/scene_plan.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

struct TrackedObject {
  std::uint32_t id = 0;
  bool seen = true;  ///< false: lost, kept where it was last seen
  Surface surface;
  ObjectPose pose;
  CellFlow cells;  ///< empty where the plan or the method does without
  double quality = 1.0;
  double visible_fraction = 1.0;
  /// What is left out; never null.
  std::shared_ptr<ScenePlan> plan = std::make_shared<ScenePlan>(PlanSettings{}, false);
  double held_share = 0.0;  ///< 0..1, the part of the surface that is held; 1: all of it is at rest
                            ///< and equals the last frame's

  [[nodiscard]] bool atRest() const { return held_share >= 1.0; }
  /// Seen and followed well enough to tell its motion; with less it is only carried on.
  [[nodiscard]] bool isWellTracked() const { return quality >= kGoodQuality; }

  static constexpr double kGoodQuality = 0.75;  ///< chosen: between 1 and one doubtful step of 0.7
};

}  // namespace hapticast::server
