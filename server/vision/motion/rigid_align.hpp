// SPDX-License-Identifier: MIT
// Finds the rigid motion of an object from one frame to the next, by direct alignment of colour and
// depth. The method is robust Gauss-Newton on two levels of an image pyramid. If the predicted
// motion leads to no good alignment, an exhaustive coarse search finds a new start. Thread: any.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "server/source/camera_model.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/motion/rigid_fit.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Template of one object: points of its surface in one frame. find() searches for them in the next
/// frame.
class RigidTemplate {
 public:
  RigidTemplate() = default;
  /// Makes the template. `gray`: the whole picture, CV_8UC1. `surface`: the object's surface, after
  /// cleanSurface(). It costs about as much time as one blur of the object's box.
  RigidTemplate(const cv::Mat& gray, const Surface& surface, const CameraModel& camera);

  /// Returns whether the object has too few points for an alignment.
  [[nodiscard]] bool empty() const { return levels_.empty(); }
  /// Returns the motion of the object from the template to `images`. The search begins at the
  /// predicted motion `guess`. If it finds no good alignment there, a second search covers 2.5
  /// times the object's size in each direction. The result has `reliable` = false if there were too
  /// few points, or if fewer than half of them agree. `pivot_mm`: centre of the rotation, camera
  /// frame.
  [[nodiscard]] RigidStep find(const FrameImages& images, const Eigen::Vector3d& pivot_mm,
                               const RigidStep& guess) const;

 private:
  struct Level {
    int factor = 1;  // px of the picture for each px of this level, each way
    std::vector<RigidPoint> points;
  };
  struct Coarse {  // reduced images for the exhaustive search
    int factor = 1;
    cv::Rect box_px;            // the object's box in pixels of the coarse picture
    cv::Mat gray, depth, mask;  ///< all of one size; mask 0..255

    /// Returns how similar this template is to a part of another picture of the same scale. `at`:
    /// position of the template's first pixel there. A larger value is better.
    [[nodiscard]] double computeLikeness(const cv::Mat& other_gray, const cv::Mat& other_depth,
                                         const cv::Point& at) const;
  };
  void addLevel(const cv::Mat& gray, const Surface& surface, int factor);
  void addOutline(const cv::Mat& inside, const cv::Mat& depth, int factor);
  [[nodiscard]] Eigen::Vector3d unproject(int u, int v, double depth_mm, int factor) const;
  [[nodiscard]] RigidStep align(const FrameImages& images, const Eigen::Vector3d& pivot_mm,
                                const RigidStep& guess) const;
  /// Returns a first guess of the motion from an exhaustive comparison of coarse pictures. It
  /// covers 2.5 times the object's size in each direction.
  [[nodiscard]] RigidStep searchMotion(const FrameImages& images,
                                       const Eigen::Vector3d& pivot_mm) const;
  /// Returns the similarity transform of the picture that best fits the outline's motion by `step`.
  [[nodiscard]] cv::Matx23d computeSimilarity(const Eigen::Vector3d& pivot_mm,
                                              const RigidStep& step) const;
  /// Returns the part of the picture in which the object lies after the motion `step`, with a
  /// margin.
  [[nodiscard]] cv::Rect findBox(const Eigen::Vector3d& pivot_mm, const RigidStep& step,
                                 const cv::Size& picture) const;

  CameraModel camera_;
  cv::Rect box_;
  DepthRange depth_;                         // range of the depths of the points
  std::vector<Level> levels_;                // the fine level, then the coarse one
  std::vector<Eigen::Vector3d> outline_mm_;  // points of the surface just inside the mask's edge
  Coarse coarse_;
};

}  // namespace hapticast::server
