// SPDX-License-Identifier: MIT
// Gauss-Newton on colour and depth together: finds the rigid motion after which a body's points
// agree best with a picture. The scheme is forward compositional (Baker and Matthews 2004). Tukey's
// weights (Beaton and Tukey 1974) make it robust against outliers. Thread: any.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/vision/motion/rigid_roi.hpp"

namespace hapticast::server {

/// Rigid motion of a point X to X' = rotation (X - pivot) + pivot + shift_mm. The pivot is not
/// stored here; functions have it as their argument `pivot_mm`. Coordinates are of the camera frame
/// (X right, Y down, Z forward, mm).
struct RigidStep {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();  ///< displacement of the pivot
  double inliers = 0.0;  ///< share of the points that agree in colour and depth, 0..1
  bool reliable = false;
  /// Maps px of the last picture to px of this picture (OpenCV's coordinates, pixel centres at
  /// whole numbers). It is the similarity that best fits the motion of the outline.
  cv::Matx23d similarity = cv::Matx23d::eye();
};

/// Returns the axis of `rotation` times its angle, rad.
Eigen::Vector3d rotationVector(const Eigen::Matrix3d& rotation);

/// A point of the body in the last frame.
struct RigidPoint {
  Eigen::Vector3d position_mm;  ///< position in the camera frame
  float gray;                   ///< grey level, 0..255
};

/// Aligns the points of one object with one picture.
class RigidFit {
 public:
  /// All arguments must outlive RigidFit. `expected_turn_rad`: predicted rotation (axis times
  /// angle). The result approaches it as far as the picture does not determine the rotation.
  RigidFit(const CameraModel& camera, const RigidRoi& crop, const std::vector<RigidPoint>& points,
           const Eigen::Vector3d& pivot_mm, const Eigen::Vector3d& expected_turn_rad);
  /// Improves the motion `step` until it converges, in at most eight iterations, and sets its share
  /// of inliers. Returns false if there is no solution; then `step` is invalid.
  bool improve(RigidStep& step);

 private:
  struct Residual {  // differences at one point, for the present estimate
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
  std::vector<float> off_;  // temporary values
};

}  // namespace hapticast::server
