// SPDX-License-Identifier: MIT
// Where an object is: a body-fixed reference point followed from frame to frame, by rigid alignment
// of colour and depth, or by the thesis's two special cases: Lucas-Kanade in x-y, depth differences
// in z. README.md of server/vision compares them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "server/vision/base/flow.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/rigid_align.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// What is new of one object in a frame.
struct Observation {
  const ObjectFlow& flow;  ///< from the last frame
  const cv::Mat& gray;     ///< of the whole picture, CV_8UC1
  const Surface& surface;
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
  PoseTracker(const PoseSettings& settings, const cv::Mat& gray, const Surface& first);

  /// Where the object went since the last frame, before its mask in this one is known; nullopt: not
  /// found. To be called at most once before advance().
  std::optional<ObjectFlow> find(const FrameImages& images);
  /// The pose in the next frame.
  ObjectPose advance(const Observation& seen);
  [[nodiscard]] const ObjectPose& pose() const { return pose_; }
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
  [[nodiscard]] Shape computeShape(const Surface& surface) const;
  [[nodiscard]] Vec3 position_mm() const;
  void setPosition(const Vec3& position_mm);
  void advanceRigidly(const Observation& seen, bool trusted);
  void advanceInPlane(const Observation& seen, const Shape& now, bool trusted);
  void advanceInDepth(const Observation& seen, bool trusted);
  /// Makes the template that the next frame is searched for.
  void remember(const cv::Mat& gray, const Surface& surface);

  PoseSettings settings_;
  ObjectPose pose_;
  Shape last_;
  Surface fresh_;                                 // the last one whose depth was no repeat
  cv::Matx33d since_fresh_ = cv::Matx33d::eye();  // its px -> the last frame's
  RigidTemplate template_;                        // the object in the last frame
  RigidStep step_;                                // from that one to this, since find()
  RigidStep last_step_;
  bool aligned_ = false;
  Vec3 aligned_about_mm_ = Vec3::Zero();  // the pivot of last_step_
};

/// Mean of now - before over the carried, eroded overlap of two surfaces, trimmed at 3 MAD (at
/// least `floor_mm`); nullopt with fewer than 20 pixels in common.
std::optional<double> depthDifference_mm(const Surface& before, const Surface& now,
                                         const cv::Matx23d& similarity, double floor_mm);

}  // namespace hapticast::server
