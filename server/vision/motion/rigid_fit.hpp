// SPDX-License-Identifier: MIT
// Gauss-Newton on colour and depth together: finds the motion of a rigid body's points that agrees
// with a picture. Forward compositional (Baker and Matthews 2004), robust by Tukey's weights
// (Beaton and Tukey 1974). Thread: any.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/vision/motion/rigid_roi.hpp"

namespace hapticast::server {

/// Rigid motion: X' = rotation (X - pivot) + pivot + shift_mm, in the camera frame (X right, Y
/// down, Z forward, mm).
struct RigidStep {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();  ///< of the pivot
  double inliers = 0.0;  ///< share of the points that agree in colour and depth, 0..1
  bool reliable = false;
  /// Maps last px to this px (OpenCV's coordinates, pixel centres at whole numbers); the similarity
  /// nearest to the motion of the outline.
  cv::Matx23d similarity{1, 0, 0, 0, 1, 0};
};

/// Converts a rotation to its axis times its angle, rad.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& rotation);

/// A point of the body in the last frame.
struct RigidPoint {
  Eigen::Vector3d position_mm;  ///< camera frame
  float gray;                   ///< level, 0..255
};

/// Alignment of one object with one picture.
class RigidFit {
 public:
  /// All arguments must outlive RigidFit. `expected_turn_rad`: the rotation without other evidence.
  RigidFit(const CameraModel& camera, const RigidRoi& crop, const std::vector<RigidPoint>& points,
           const Eigen::Vector3d& pivot_mm, const Eigen::Vector3d& expected_turn_rad);
  /// Improves `step` until it converges, at most eight times, and sets its share of inliers.
  /// Returns false if there is no solution; then `step` is invalid.
  bool improve(RigidStep& step);

 private:
  struct Residual {  // of one point for the present estimate
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
