// SPDX-License-Identifier: MIT
// Pose of an object in one frame. Thread: any.
#pragma once

#include <opencv2/core.hpp>

#include "common/geometry.hpp"
#include "common/haptic_frame.hpp"
#include "server/source/camera_model.hpp"
#include "server/vision/motion/savitzky_golay.hpp"

namespace hapticast::server {

/// Pose of an object in one frame: position of its reference point in the picture, depth of this
/// point, and rotation about the viewing axis. Positions are in px, with pixel centres at +0.5.
struct ObjectPose {
  double u_px = 0.0;
  double v_px = 0.0;
  double depth_mm = 0.0;   ///< depth of the reference point, mm; larger is farther
  double angle_rad = 0.0;  ///< rotation about +z (towards the viewer), right-handed
  bool seen = true;        ///< false: too little was visible, and the position is a prediction
  /// False: the depth is that of the last frame, because the source repeated it.
  bool depth_seen = true;
  /// False: the rigid alignment failed, and a less exact method found the pose. A jump to this pose
  /// may then be an error.
  bool confident = true;
  ReferencePoint point = ReferencePoint::kVisibleCentroid;
  /// Sum of the background's motion at the object since its track began, px; 0 without pan
  /// compensation.
  cv::Vec2d background_px{0, 0};
};

/// The workspace of the stream, and the mapped range (depths that become heights 30 and 0).
/// Together they define the conversion of px and mm of depth to nominal mm. Thread: any.
struct NominalFrame {
  Workspace workspace;
  DepthRange range;

  /// Returns `pose` in nominal mm. `time_s`: time of its frame, s.
  [[nodiscard]] Sample sample(const ObjectPose& pose, double time_s) const;
  /// Returns the nominal mm that correspond to 1 px to the right, 1 px down and 1 mm of depth.
  [[nodiscard]] Vec3 mmPerStep() const;
};

}  // namespace hapticast::server
