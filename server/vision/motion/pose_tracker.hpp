// SPDX-License-Identifier: MIT
// Pose tracking: follows a body-fixed reference point from frame to frame by rigid alignment of
// colour and depth (direct RGB-D alignment).
// The thesis's special cases are available too: Lucas-Kanade in x-y, depth differences in z.
// README.md of server/vision compares them. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "server/vision/base/flow.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/rigid_align.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Observation of one object in a frame.
struct Observation {
  const ObjectFlow& flow;         ///< from the last frame
  const cv::Mat& gray;            ///< whole picture, CV_8UC1
  const Surface& surface;         ///< of the object in this frame
  bool repeated = false;          ///< the depth repeats the last frame, the colour does not
  bool at_rest = false;           ///< all of the surface is held: the pose remains exactly the same
  double visible_fraction = 1.0;  ///< of the whole object, 0..1
};

/// Settings of a whole track.
struct PoseSettings {
  MotionMode mode = MotionMode::kAuto;
  bool rigid = true;         ///< auto and rgbd align; the thesis's method does not
  bool exact_masks = false;  ///< the source's own masks
  CameraModel camera;
  cv::Size picture;  ///< size of the picture, px
};

/// Pose of one object. In modes `auto` and `rgbd` the rigid alignment moves a point in the middle
/// of the body. Outline and depth pull this point slowly (3.5 % a frame) to their centre.
/// If alignment fails, and in modes `lk` and `depth`, the robust flow moves the point and the
/// mask's centroid pulls it. In mode `auto` with exact masks the point follows the centroid itself.
/// Depth then changes by the mean difference over the warped, eroded mask.
class PoseTracker {
 public:
  /// Starts at the surface `first`. `gray`: the whole picture, CV_8UC1.
  PoseTracker(const PoseSettings& settings, const cv::Mat& gray, const Surface& first);

  /// Aligns the object's template with this frame, whose mask is unknown yet. Returns its flow;
  /// nullopt if not found. Call at most once before advance().
  std::optional<ObjectFlow> find(const FrameImages& images);
  /// Adds the next frame and returns its pose.
  ObjectPose advance(const Observation& seen);
  [[nodiscard]] const ObjectPose& pose() const { return pose_; }
  /// Returns whether the last advance() was a rigid alignment.
  [[nodiscard]] bool aligned() const { return aligned_; }
  /// Returns the displacement of a point of the last frame's surface by that alignment: px, px and
  /// mm. `at_px`: centres at whole numbers.
  [[nodiscard]] cv::Vec3d explained(const cv::Point2f& at_px, double depth_mm) const;

 private:
  struct Shape {  // outline in one frame
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
  /// Makes the template for the search in the next frame.
  void remember(const cv::Mat& gray, const Surface& surface);

  PoseSettings settings_;
  ObjectPose pose_;
  Shape last_;
  Surface fresh_;                                 // last surface whose depth was no repeat
  cv::Matx33d since_fresh_ = cv::Matx33d::eye();  // maps its px to the last frame's px
  RigidTemplate template_;                        // the object in the last frame
  RigidStep step_;                                // from the template to this frame, since find()
  RigidStep last_step_;
  bool aligned_ = false;
  Vec3 aligned_about_mm_ = Vec3::Zero();  // pivot of last_step_
};

/// Returns the mean of now - before, mm, over the warped, eroded overlap of two surfaces. Values
/// beyond 3 MAD (at least `floor_mm`) do not count. nullopt with fewer than 20 common pixels.
std::optional<double> depthDifference_mm(const Surface& before, const Surface& now,
                                         const cv::Matx23d& similarity, double floor_mm);

}  // namespace hapticast::server
