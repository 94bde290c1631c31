// SPDX-License-Identifier: MIT
#include "server/vision/motion/rigid_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/least_squares.hpp"
#include "server/vision/base/statistics.hpp"

namespace hapticast::server {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr int kRounds = 8;          // chosen: usually five suffice
constexpr double kDone_px = 0.002;  // a smaller step changes no perceptible velocity
// Chosen: lower limits of the standard deviations; smaller residuals are equally good.
constexpr double kGrayFloor = 1.5;  // grey levels
constexpr double kDepthFloor_mm = 0.7;
// Standard deviations: 95 % efficient (4.685; Huber, Robust Statistics).
constexpr double kTukey = 4.6;
// Chosen: points with larger residuals count as not found.
constexpr double kGrayInlier = 30.0;  // grey levels
constexpr double kDepthInlier_mm = 25.0;
// Chosen: weak, so that it decides only without other evidence.
constexpr double kSpinPrior_rad = 0.05;

double tukey(double residual, double sigma) {
  const double x = residual / (kTukey * sigma);
  if (std::abs(x) >= 1.0) return 0.0;
  const double y = 1.0 - x * x;
  return y * y / (sigma * sigma);
}

Matrix3d rotationMatrix(const Vector3d& turn_rad) {
  const double angle = turn_rad.norm();
  if (angle < 1e-12) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, turn_rad / angle).toRotationMatrix();
}

}  // namespace

Vector3d rotationVector(const Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

struct RigidFit::Normal {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  void add(const Vector6d& row, double residual, double weight) {
    matrix.noalias() += weight * row * row.transpose();
    right.noalias() -= weight * residual * row;
  }
};

RigidFit::RigidFit(const CameraModel& camera, const RigidRoi& crop,
                   const std::vector<RigidPoint>& points, const Vector3d& pivot_mm,
                   const Vector3d& expected_turn_rad)
    : camera_(camera),
      crop_(crop),
      points_(points),
      pivot_mm_(pivot_mm),
      expected_turn_rad_(expected_turn_rad),
      residuals_(points.size()) {}

void RigidFit::computeResiduals(const RigidStep& step) {
  const Vector3d pivot = pivot_mm_ + step.shift_mm;
  for (std::size_t i = 0; i < residuals_.size(); ++i) {
    Residual& s = residuals_[i];
    s.position_mm = step.rotation * (points_[i].position_mm - pivot_mm_) + pivot;
    const Vector3d& x = s.position_mm;
    s.valid = x.z() > 1.0 && crop_.sample(crop_.place(camera_.project(x)), s.texel);
    if (!s.valid) continue;
    s.gray_residual = double(s.texel.gray) - double(points_[i].gray);
    s.depth_residual_mm = double(s.texel.depth) - x.z();
  }
}

// Removes a change of light.
void RigidFit::removeBias() {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Residual& s : residuals_) {
    if (!s.valid || std::abs(s.gray_residual) >= kGrayInlier) continue;
    sum += s.gray_residual;
    ++count;
  }
  if (count == 0) return;
  for (Residual& s : residuals_) s.gray_residual -= sum / double(count);
}

double RigidFit::inliers() const {
  const auto agrees = [](const Residual& s) {
    return s.valid && s.texel.depth > 0 && std::abs(s.gray_residual) < kGrayInlier &&
           std::abs(s.depth_residual_mm) < kDepthInlier_mm;
  };
  return double(std::count_if(residuals_.begin(), residuals_.end(), agrees)) /
         double(std::max<std::size_t>(1, residuals_.size()));
}

// Adds the rows of the two residuals with respect to (shift, rotation about the pivot).
void RigidFit::addPoint(const Residual& at, const Vector3d& pivot, double gray_sigma,
                        double depth_sigma, Normal& normal) const {
  const Vector3d& x = at.position_mm;
  const double inverse = 1.0 / x.z();
  const double fu = camera_.fx_px * inverse / crop_.factor;
  const double fv = camera_.fy_px * inverse / crop_.factor;
  const Vector3d du(fu, 0.0, -fu * x.x() * inverse);
  const Vector3d dv(0.0, fv, -fv * x.y() * inverse);
  const Vector3d arm = x - pivot;
  const auto row = [&](const Vector3d& gradient) {
    Vector6d out;
    out << gradient, arm.cross(gradient);
    return out;
  };
  const Texel& texel = at.texel;
  const double gray_weight = tukey(at.gray_residual, gray_sigma);
  if (gray_weight > 0) {
    normal.add(row(double(texel.gray_u) * du + double(texel.gray_v) * dv), at.gray_residual,
               gray_weight);
  }
  if (texel.depth <= 0) return;
  const double depth_weight = tukey(at.depth_residual_mm, depth_sigma);
  if (depth_weight <= 0) return;
  normal.add(row(double(texel.depth_u) * du + double(texel.depth_v) * dv - Vector3d::UnitZ()),
             at.depth_residual_mm, depth_weight);
}

RigidFit::Normal RigidFit::equations(const RigidStep& step) {
  off_.clear();
  for (const Residual& s : residuals_) {
    if (s.valid) off_.push_back(static_cast<float>(std::abs(s.gray_residual)));
  }
  const double gray_sigma = std::max(kGrayFloor, sigmaByMedian(off_));
  off_.clear();
  for (const Residual& s : residuals_) {
    if (s.valid && s.texel.depth > 0)
      off_.push_back(static_cast<float>(std::abs(s.depth_residual_mm)));
  }
  const double depth_sigma = std::max(kDepthFloor_mm, sigmaByMedian(off_));
  Normal out;
  const Vector3d pivot = pivot_mm_ + step.shift_mm;
  for (const Residual& s : residuals_) {
    if (s.valid) addPoint(s, pivot, gray_sigma, depth_sigma, out);
  }
  const double prior = 1.0 / (kSpinPrior_rad * kSpinPrior_rad);
  out.matrix.diagonal().tail<3>().array() += prior;
  out.right.tail<3>() -= prior * (rotationVector(step.rotation) - expected_turn_rad_);
  out.matrix.diagonal().head<3>().array() += 1e-6;
  return out;
}

bool RigidFit::improve(RigidStep& step) {
  for (int round = 0; round < kRounds; ++round) {
    computeResiduals(step);
    removeBias();
    step.inliers = inliers();
    const Normal normal = equations(step);
    const Vector6d change = solveNormal(normal.matrix, normal.right);
    if (!change.allFinite()) return false;
    const double depth_mm = std::max(1.0, pivot_mm_.z() + step.shift_mm.z());
    step.shift_mm += change.head<3>();
    step.rotation = rotationMatrix(change.tail<3>()) * step.rotation;
    const double moved_px = change.head<3>().norm() * camera_.fx_px / depth_mm;
    if (moved_px < kDone_px * crop_.factor) break;
  }
  return true;
}

}  // namespace hapticast::server
