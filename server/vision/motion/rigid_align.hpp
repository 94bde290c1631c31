// SPDX-License-Identifier: MIT
// How a rigid object moved in space from one frame to the next: direct alignment of its colour and
// depth by Gauss-Newton, robust, on two levels. Thread: any; values.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "server/source/camera_model.hpp"
#include "server/vision/base/frame_images.hpp"
#include "server/vision/motion/rigid_fit.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// One object as it looks in a frame: the points that are looked for in the next one.
class RigidTemplate {
 public:
  RigidTemplate() = default;
  /// Costs one blur of the object's box. `surface` is the object's, cleaned.
  RigidTemplate(const cv::Mat& gray, const Surface& surface, const CameraModel& camera);

  [[nodiscard]] bool empty() const { return levels_.empty(); }
  /// Finds the object again in `images`, near where `guess` says, else within about its own size.
  /// Not reliable: fewer than half of the points agree, or there were too few.
  [[nodiscard]] RigidStep find(const FrameImages& images, const Eigen::Vector3d& pivot_mm,
                               const RigidStep& guess) const;

 private:
  struct Level {
    int factor = 1;  // px of the picture per px of this level, each way
    std::vector<RigidPoint> points;
  };
  struct Coarse {  // for the search where the guess is of no use
    int factor = 1;
    cv::Rect box_px;  // whole pixels of the coarse picture
    cv::Mat gray, depth, mask;

    /// How alike a place (its first pixel) of another picture of this scale is: more is better.
    [[nodiscard]] double likeness(const cv::Mat& other_gray, const cv::Mat& other_depth,
                                  const cv::Point& at) const;
  };
  void addLevel(const cv::Mat& gray, const Surface& surface, int factor);
  void addOutline(const cv::Mat& inside, const cv::Mat& depth, int factor);
  [[nodiscard]] Eigen::Vector3d unproject(int u, int v, double depth_mm, int factor) const;
  [[nodiscard]] RigidStep align(const FrameImages& images, const Eigen::Vector3d& pivot_mm,
                                const RigidStep& guess) const;
  /// A first guess by comparing the coarse picture place by place within about the object's size.
  [[nodiscard]] RigidStep searched(const FrameImages& images,
                                   const Eigen::Vector3d& pivot_mm) const;
  /// The similarity nearest to what the outline does in a step.
  [[nodiscard]] cv::Matx23d computeSimilarity(const Eigen::Vector3d& pivot_mm,
                                              const RigidStep& step) const;
  [[nodiscard]] cv::Rect whereWith(const Eigen::Vector3d& pivot_mm, const RigidStep& step,
                                   const cv::Size& picture) const;

  CameraModel camera_;
  cv::Rect box_;
  DepthRange depth_;                         // of the points
  std::vector<Level> levels_;                // fine, coarse
  std::vector<Eigen::Vector3d> outline_mm_;  // of the surface just inside the mask's edge
  Coarse coarse_;
};

}  // namespace hapticast::server
