// SPDX-License-Identifier: MIT
// From poses in the picture to nominal units. Thread: any; values.
#pragma once

#include "common/geometry.hpp"
#include "server/source/camera_model.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// The workspace that is announced and the range of working depth that becomes its heights.
struct NominalFrame {
  Workspace workspace;
  DepthRange range;

  [[nodiscard]] Sample sample(const ObjectPose& pose, double time_s) const;
  /// Nominal mm per px right, px down and mm of working depth.
  [[nodiscard]] Vec3 mmPerStep() const;
};

}  // namespace hapticast::server
