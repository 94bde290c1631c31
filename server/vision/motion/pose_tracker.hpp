// SPDX-License-Identifier: MIT
// Where an object is: a body-fixed reference point followed from frame to frame, by rigid alignment
// of colour and depth, or by the thesis's two special cases: Lucas-Kanade in x-y, depth differences
// in z (motion notes, section 2).
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "server/vision/base/flow.hpp"
#include "server/vision/motion/rigid_align.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision.hpp"

namespace hapticast::server {

/// The reference point in the picture (px, pixel centres at +0.5) and in depth, and the turn about
/// the viewing axis.
struct Pose {
  double u_px = 0.0;
  double v_px = 0.0;
  double depth_mm = 0.0;   ///< working depth
  double angle_rad = 0.0;  ///< about +z (towards the viewer), right-handed
  bool seen = true;        ///< false: too little of it was seen, the position is a prediction
  bool depth_seen = true;  ///< false: this frame's depth was a repeat of the last one's
  bool sure = true;  ///< false: alignment failed and another method took over; it may be off by
                     ///< a jump
  ReferencePoint point = ReferencePoint::kVisibleCentroid;
  cv::Vec2d background_px{0, 0};  ///< how far the background has moved here since the track began;
                                  ///< set by who compensates the camera's pan
};

/// What is new of one object in a frame.
struct Observation {
  const ObjectFlow& flow;  ///< from the last frame
  const View& view;
  const Surface& surface;
  bool identical = false;         ///< the frame equals the last one
  bool repeated = false;          ///< its depth is the last frame's, its colour is not
  bool at_rest = false;           ///< all of the surface is held: the pose stays exactly as it is
  double visible_fraction = 1.0;  ///< of the whole object, 0..1
};

/// What stays the same over a track.
struct PoseSettings {
  MotionMode mode = MotionMode::kAuto;
  bool rigid = true;         ///< auto and rgbd align; the thesis's method never does
  bool exact_masks = false;  ///< the source's own
  CameraModel camera;
  cv::Size picture;
};

/// Follows one object. `rgbd` (and auto): a point in the middle of the body, carried by the rigid
/// alignment and pulled slowly (3.5 % a frame) to where outline and depth say it is. Where that
/// fails, and with `lk` and `depth`: carried by the robust flow and pulled to the mask's centroid
/// (auto, with the source's own exact masks: the centroid itself), in depth by the mean difference
/// over the carried, eroded mask.
class PoseTracker {
 public:
  PoseTracker(const PoseSettings& settings, const View& view, const Surface& first);

  /// Where the object went since the last frame, before its mask in this one is known; false: not
  /// found, nothing is changed. To be called at most once before advance().
  bool find(const View& view, ObjectFlow& flow);
  /// The pose in the next frame.
  Pose advance(const Observation& seen);
  [[nodiscard]] const Pose& pose() const { return pose_; }
  /// Whether the last advance() was a rigid alignment; then where it says that a point of the last
  /// frame's surface went: px, px (centres at whole numbers) and mm.
  [[nodiscard]] bool aligned() const { return aligned_; }
  [[nodiscard]] cv::Vec3d explained(const cv::Point2f& at_px, double depth_mm) const;

 private:
  struct Shape {  // of one frame
    cv::Point2d centroid;
    double area_px = 0.0;
    bool entire = false;  // does not touch the picture's border
  };
  [[nodiscard]] Shape shapeOf(const Surface& surface) const;
  [[nodiscard]] Vec3 position_mm() const;
  void setPosition(const Vec3& position_mm);
  void advanceRigidly(const Observation& seen, bool trusted);
  void advanceInPlane(const Observation& seen, const Shape& now, bool trusted);
  void advanceInDepth(const Observation& seen, bool trusted);
  void look(const View& view, const Surface& surface);

  PoseSettings settings_;
  Pose pose_;
  Shape last_;
  Surface fresh_;                                 // the last one whose depth was no repeat
  cv::Matx33d since_fresh_ = cv::Matx33d::eye();  // its px -> the last frame's
  RigidTemplate template_;                        // the object in the last frame
  RigidStep step_;                                // to this frame, since find()
  RigidStep last_step_;
  bool aligned_ = false;
  Vec3 aligned_about_mm_ = Vec3::Zero();  // the pivot of last_step_
};

/// Mean of now - before over the carried, eroded overlap of two surfaces, trimmed at 3 MAD (at
/// least `floor_mm`); nullopt with fewer than 20 pixels in common.
std::optional<double> depthDifference_mm(const Surface& before, const Surface& now,
                                         const cv::Matx23d& similarity, double floor_mm);

}  // namespace hapticast::server
