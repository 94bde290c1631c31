// SPDX-License-Identifier: MIT
// Where an object is in one frame. Plain values. Thread: any.
#pragma once

#include <opencv2/core.hpp>

#include "common/haptic_frame.hpp"

namespace hapticast::server {

/// The reference point in the picture (px, pixel centres at +0.5) and in depth, and the turn about
/// the viewing axis.
struct ObjectPose {
  double u_px = 0.0;
  double v_px = 0.0;
  double depth_mm = 0.0;   ///< working depth
  double angle_rad = 0.0;  ///< about +z (towards the viewer), right-handed
  bool seen = true;        ///< false: too little of it was seen, the position is a prediction
  bool depth_seen = true;  ///< false: this frame's depth was a repeat of the last one's
  bool confident = true;   ///< false: alignment failed and another method took over; it may be off
                          ///< by a jump
  ReferencePoint point = ReferencePoint::kVisibleCentroid;
  cv::Vec2d background_px{0, 0};  ///< how far the background has moved here since the track began;
                                  ///< set by who compensates the camera's pan
};

}  // namespace hapticast::server
