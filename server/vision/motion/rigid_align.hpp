// SPDX-License-Identifier: MIT
// Direct rigid alignment of colour and depth from one frame to the next: robust Gauss-Newton on two
// levels, with an exhaustive coarse search if the prediction fails. Thread: any.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "server/source/camera_model.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "server/vision/motion/rigid_fit.hpp"
#include "server/vision/surface/enhance.hpp"

namespace hapticast::server {

/// Template of one object in a frame: the points to find in the next frame.
class RigidTemplate {
 public:
  RigidTemplate() = default;
  /// Costs one blur of the object's box. `gray`: the whole picture, CV_8UC1. `surface`: the
  /// object's cleaned surface.
  RigidTemplate(const cv::Mat& gray, const Surface& surface, const CameraModel& camera);

  /// Returns whether the object has too few points for an alignment.
  [[nodiscard]] bool empty() const { return levels_.empty(); }
  /// Finds the object in `images`: near the prediction `guess`, else within about its own size.
  /// `pivot_mm`: centre of the rotation, camera frame.
  /// The result is not reliable if there were too few points, or fewer than half of them agree.
  [[nodiscard]] RigidStep find(const FrameImages& images, const Eigen::Vector3d& pivot_mm,
                               const RigidStep& guess) const;

 private:
  struct Level {
    int factor = 1;  // px of the picture for each px of this level, each way
    std::vector<RigidPoint> points;
  };
  struct Coarse {  // for the search if the prediction fails
    int factor = 1;
    cv::Rect box_px;            // whole pixels of the coarse picture
    cv::Mat gray, depth, mask;  ///< of one size; mask 0..255

    /// Returns the similarity of the template to another picture of this scale, with the template's
    /// first pixel at `at`. Larger is better.
    [[nodiscard]] double likeness(const cv::Mat& other_gray, const cv::Mat& other_depth,
                                  const cv::Point& at) const;
  };
  void addLevel(const cv::Mat& gray, const Surface& surface, int factor);
  void addOutline(const cv::Mat& inside, const cv::Mat& depth, int factor);
  [[nodiscard]] Eigen::Vector3d unproject(int u, int v, double depth_mm, int factor) const;
  [[nodiscard]] RigidStep align(const FrameImages& images, const Eigen::Vector3d& pivot_mm,
                                const RigidStep& guess) const;
  /// Returns a first guess: an exhaustive comparison of the coarse picture within about the
  /// object's size.
  [[nodiscard]] RigidStep searched(const FrameImages& images,
                                   const Eigen::Vector3d& pivot_mm) const;
  /// Returns the similarity nearest to the motion of the outline in `step`.
  [[nodiscard]] cv::Matx23d computeSimilarity(const Eigen::Vector3d& pivot_mm,
                                              const RigidStep& step) const;
  /// Returns the part of the picture to search after `step`.
  [[nodiscard]] cv::Rect whereWith(const Eigen::Vector3d& pivot_mm, const RigidStep& step,
                                   const cv::Size& picture) const;

  CameraModel camera_;
  cv::Rect box_;
  DepthRange depth_;                         // depths of the points
  std::vector<Level> levels_;                // fine, coarse
  std::vector<Eigen::Vector3d> outline_mm_;  // surface just inside the mask's edge
  Coarse coarse_;
};

}  // namespace hapticast::server
