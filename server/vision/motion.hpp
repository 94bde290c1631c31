// SPDX-License-Identifier: MIT
// Where an object is: a body-fixed reference point followed from frame to frame. The thesis's two
// special cases: Lucas-Kanade in x-y, depth differences in z (motion notes, section 2).
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "server/vision/enhance.hpp"
#include "server/vision/flow.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// The reference point in the picture (px, pixel centres at +0.5) and in depth, and the turn about
/// the viewing axis.
struct Pose {
  double u_px = 0.0;
  double v_px = 0.0;
  double depth_mm = 0.0;   ///< working depth
  double angle_rad = 0.0;  ///< about +z (towards the viewer), right-handed
  bool depth_seen = true;  ///< false: this frame's depth was a repeat of the last one's
};

/// What is new of one object in a frame.
struct Observation {
  const ObjectFlow& flow;  ///< from the last frame
  const Surface& surface;
  bool identical = false;  ///< the frame equals the last one
  bool repeated = false;   ///< its depth is the last frame's, its colour is not
  bool at_rest = false;    ///< all of the surface is held: the pose stays exactly as it is
};

/// Follows one object. The point is carried by the robust flow and pulled slowly (5 % a frame) to
/// the mask's centroid; with the source's own exact masks the centroid itself is followed as long
/// as the whole object is seen, because the flow of a round body's surface is not its motion. Depth
/// likewise: mean difference over the carried, eroded mask; with exact masks the mean over the
/// inner mask.
class PoseTracker {
 public:
  PoseTracker(MotionMode mode, bool exact_masks, const cv::Size& picture, const Surface& first);

  /// The pose in the next frame.
  Pose advance(const Observation& seen);
  [[nodiscard]] const Pose& pose() const { return pose_; }

 private:
  struct Shape {  // of one frame
    cv::Point2d centroid;
    double depth_mm = 0.0;
    double area_px = 0.0;
    bool entire = false;  // does not touch the picture's border
  };
  [[nodiscard]] Shape shapeOf(const Surface& surface) const;
  void advanceInPlane(const Observation& seen, const Shape& now, bool trusted);
  void advanceInDepth(const Observation& seen, const Shape& now, bool trusted);

  MotionMode mode_;
  bool exact_masks_;
  cv::Size picture_;
  Pose pose_;
  Shape last_;
  Surface fresh_;                                 // the last one whose depth was no repeat
  cv::Matx33d since_fresh_ = cv::Matx33d::eye();  // its px -> the last frame's
};

/// Mean of now - before over the carried, eroded overlap of two surfaces, trimmed at 3 MAD (at
/// least `floor_mm`); nullopt with fewer than 20 pixels in common.
std::optional<double> depthDifference_mm(const Surface& before, const Surface& now,
                                         const cv::Matx23d& similarity, double floor_mm);

}  // namespace hapticast::server
