// SPDX-License-Identifier: MIT
// Conversion of poses in the picture to nominal units. Thread: any.
#pragma once

#include "common/geometry.hpp"
#include "server/source/camera_model.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// The announced workspace, and the range of working depth that becomes its heights.
struct NominalFrame {
  Workspace workspace;
  DepthRange range;

  /// Converts `pose` to nominal mm. `time_s`: time of its frame.
  [[nodiscard]] Sample sample(const ObjectPose& pose, double time_s) const;
  /// Returns nominal mm per px right, px down and mm of working depth.
  [[nodiscard]] Vec3 mmPerStep() const;
};

}  // namespace hapticast::server
