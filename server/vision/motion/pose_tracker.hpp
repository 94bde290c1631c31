// SPDX-License-Identifier: MIT
// Pose tracking: measures from frame to frame how a point that is fixed to the body moves. It
// aligns colour and depth of the object rigidly (direct RGB-D alignment). It also has the thesis's
// methods: Lucas-Kanade for motion in x and y, depth differences for motion in z. README.md of
// server/vision compares the methods. Thread: the one that runs Vision.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "server/vision/base/flow.hpp"
#include "server/vision/motion/grid.hpp"
#include "server/vision/motion/object_pose.hpp"
#include "server/vision/motion/rigid_align.hpp"
#include "server/vision/surface/enhance.hpp"
#include "server/vision/vision_settings.hpp"

namespace hapticast::server {

/// Input of the tracker: one object in one frame.
struct Observation {
  const ObjectFlow& flow;  ///< motion in the picture from the last frame to this frame
  const cv::Mat& gray;     ///< whole picture, CV_8UC1
  const Surface& surface;  ///< surface of the object in this frame
  bool repeated = false;   ///< the source repeated the last frame's depth, but the colour is new
  bool at_rest = false;    ///< the whole surface is at rest: the pose does not change
  double visible_fraction = 1.0;  ///< visible share of the whole object, 0..1
};

/// Settings of a whole track.
struct PoseSettings {
  MotionMode mode = MotionMode::kAuto;
  /// Whether the object is aligned rigidly: true in modes `auto` and `rgbd`, but false for the
  /// thesis's method.
  bool rigid = true;
  bool exact_masks = false;  ///< whether the masks are the source's own
  CameraModel camera;
  cv::Size picture;  ///< size of the picture, px
};

/// Tracks the pose of one object, that is, of a point in the middle of its body. In modes `auto`
/// and `rgbd`, rigid alignment moves the point. In each frame the point also moves towards the
/// body's centre (computeCentre()), by about 3 % of the distance. If the alignment fails, the
/// optical flow moves the point in the picture, and the point also moves towards the mask's
/// centroid. The point's depth then changes by the mean difference between the last surface and
/// this surface. With exact masks, a point without alignment moves with the mask's centroid alone.
/// Modes `lk` and `depth` have no alignment: `lk` moves the point in the picture only, `depth` in
/// depth only.
class PoseTracker {
 public:
  /// Begins the track at the surface `first`. `gray`: the whole picture, CV_8UC1.
  PoseTracker(const PoseSettings& settings, const cv::Mat& gray, const Surface& first);

  /// Searches for the object in this frame before its mask has been computed. Returns the object's
  /// motion in the picture, or nullopt if it was not found. Call it at most once before advance().
  std::optional<ObjectFlow> find(const FrameImages& images);
  /// Adds the object's observation in the next frame and returns its pose there.
  ObjectPose advance(const Observation& seen);
  [[nodiscard]] const ObjectPose& pose() const { return pose_; }
  /// Returns whether the last call of advance() aligned the object rigidly.
  [[nodiscard]] bool aligned() const { return aligned_; }
  /// Returns how the last alignment displaced the points of the last frame's surface. Later frames
  /// do not change the result.
  [[nodiscard]] PredictedMotion predictMotion() const;

 private:
  struct Shape {  // the object's outline in one frame
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
  Surface fresh_;                                 // last surface whose depth was new
  cv::Matx33d since_fresh_ = cv::Matx33d::eye();  // maps px of fresh_ to px of the last frame
  RigidTemplate template_;                        // the object in the last frame
  RigidStep step_;  // motion from the template to this frame, as find() measured it
  RigidStep last_step_;
  bool aligned_ = false;
  Vec3 aligned_about_mm_ = Vec3::Zero();  // pivot of last_step_
};

/// Returns the mean change of depth from `before` to `now`, mm. Returns nullopt if the surfaces
/// have fewer than 20 pixels in common. `similarity` moves `before` onto `now`. Two kinds of pixels
/// do not count: those near the edge of the overlap, and those whose change differs too much from
/// the median change. The limit is `floor_mm`, or 3 standard deviations (by the median absolute
/// deviation) if that is larger.
std::optional<double> depthDifference_mm(const Surface& before, const Surface& now,
                                         const cv::Matx23d& similarity, double floor_mm);

}  // namespace hapticast::server
