// SPDX-License-Identifier: MIT
// Gauss-Newton on colour and depth together: how points of a rigid body have to move to agree with
// a picture. Robust (Tukey's weights), forward compositional. Thread: any.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/vision/motion/rigid_roi.hpp"

namespace hapticast::server {

/// X' = rotation (X - pivot) + pivot + shift_mm, in the camera frame (X right, Y down, Z forward,
/// mm).
struct RigidStep {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();  ///< of the pivot
  double inliers = 0.0;  ///< share of the points that agree in colour and depth, 0..1
  bool reliable = false;
  /// last px -> this px (OpenCV's coordinates, pixel centres at whole numbers), as near as a
  /// similarity comes to what the outline did.
  cv::Matx23d similarity{1, 0, 0, 0, 1, 0};
};

/// A rotation as its axis times its angle, rad.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& rotation);

/// A point of the body in the last frame.
struct RigidPoint {
  Eigen::Vector3d position_mm;
  float gray;
};

class RigidFit {
 public:
  /// All must outlive it. `expected_turn_rad`: where nothing shows a rotation it is this one.
  RigidFit(const CameraModel& camera, const RigidRoi& crop, const std::vector<RigidPoint>& points,
           const Eigen::Vector3d& pivot_mm, const Eigen::Vector3d& expected_turn_rad);
  /// Improves `step` until it rests, at most eight times, and sets its share of inliers. False: no
  /// solution, `step` is of no use.
  bool improve(RigidStep& step);

 private:
  struct Residual {  // of one point with the present estimate
    Eigen::Vector3d position_mm;
    Texel texel;
    double gray_residual = 0.0;
    double depth_residual_mm = 0.0;
    bool valid = false;
  };
  struct Normal;
  void computeResiduals(const RigidStep& step);
  void removeBias();
  [[nodiscard]] double inliers() const;
  [[nodiscard]] Normal equations(const RigidStep& step);
  void addPoint(const Residual& at, const Eigen::Vector3d& pivot, double gray_sigma,
                double depth_sigma, Normal& normal) const;

  const CameraModel& camera_;
  const RigidRoi& crop_;
  const std::vector<RigidPoint>& points_;
  Eigen::Vector3d pivot_mm_;
  Eigen::Vector3d expected_turn_rad_;
  std::vector<Residual> residuals_;
  std::vector<float> off_;  // scratch
};

}  // namespace hapticast::server
