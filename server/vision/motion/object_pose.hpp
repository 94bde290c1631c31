// SPDX-License-Identifier: MIT
// Pose of an object in one frame. Thread: any.
#pragma once

#include <opencv2/core.hpp>

#include "common/geometry.hpp"
#include "common/haptic_frame.hpp"
#include "server/source/camera_model.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// Reference point in the picture (px, pixel centres at +0.5) and in depth, and the rotation about
/// the viewing axis.
struct ObjectPose {
  double u_px = 0.0;
  double v_px = 0.0;
  double depth_mm = 0.0;   ///< working depth
  double angle_rad = 0.0;  ///< about +z (towards the viewer), right-handed
  bool seen = true;        ///< false: too little was visible, the position is a prediction
  bool depth_seen = true;  ///< false: this frame repeats the last frame's depth
  /// False: alignment failed and a fallback was used; its error may be a jump.
  bool confident = true;
  ReferencePoint point = ReferencePoint::kVisibleCentroid;
  /// Motion of the background here since the track began; 0 without pan compensation.
  cv::Vec2d background_px{0, 0};
};

// Conversion of poses in the picture to nominal units. Thread: any.

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
