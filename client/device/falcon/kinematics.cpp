// SPDX-License-Identifier: MIT
#include "client/device/falcon/kinematics.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticast::client {

namespace {

// Lengths and azimuths of the device in m, as in working open drivers.
constexpr double kArm_m = 0.060;
constexpr double kRod_m = 0.1025;    // long side of the parallelogram
constexpr double kShort_m = 0.0225;  // its two short sides
constexpr double kGripOut_m = 0.01443;
constexpr double kGripAside_m = -0.025;
constexpr double kBaseOut_m = 0.0400;
constexpr double kBaseAside_m = -0.02309;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<double, 3> kAzimuth_rad = {105.0 * kDegree, -15.0 * kDegree, -135.0 * kDegree};
// 320 slots with four counts each per turn of the motor; drum and sector are the gear. At count
// zero the arms are at about 35 degrees, as in the drivers.
constexpr double kRadPerCount = 2.0 * std::numbers::pi / 1280.0 * 14.25 / 110.0;
constexpr double kZero_rad = 35.0 * kDegree;

// Newton's method. Chosen: 6 steps were the most over 2000 random poses.
constexpr int kMostSteps = 12;
constexpr double kLongestStep_m = 0.020;
constexpr double kGood_rad = 1e-11;
// Below this determinant the three rows are nearly coplanar (each is about 20 rad/m long).
constexpr double kLeastDeterminant = 50.0;

/// One arm with its rod.
struct Leg {
  double angle_rad = 0.0;
  double cos_rod = 0.0, sin_rod = 0.0;      // direction of the rod in the plane of the arm
  double cos_aside = 0.0, sin_aside = 0.0;  // and out of that plane
};

std::optional<Leg> solveLeg(const Vec3& position_m, double azimuth_rad) noexcept {
  const double c = std::cos(azimuth_rad);
  const double s = std::sin(azimuth_rad);
  const double u = c * position_m.x() + s * position_m.y() - kBaseOut_m;
  const double v = -s * position_m.x() + c * position_m.y() - kBaseAside_m;
  const double w = position_m.z();
  Leg leg;
  leg.cos_aside = (v + kGripAside_m) / kRod_m;
  if (!(std::abs(leg.cos_aside) <= 1.0)) return std::nullopt;
  leg.sin_aside = std::sqrt(1.0 - leg.cos_aside * leg.cos_aside);
  const double reach_m = kShort_m + kRod_m * leg.sin_aside;
  const double out_m = u + kGripOut_m;
  const double way_m = std::hypot(out_m, w);
  const double cosine =
      (way_m * way_m + kArm_m * kArm_m - reach_m * reach_m) / (2.0 * kArm_m * way_m);
  if (!(std::abs(cosine) <= 1.0)) return std::nullopt;
  leg.angle_rad = std::atan2(w, out_m) - std::acos(cosine);
  leg.cos_rod = (out_m - kArm_m * std::cos(leg.angle_rad)) / reach_m;
  leg.sin_rod = (w - kArm_m * std::sin(leg.angle_rad)) / reach_m;
  return leg;
}

using Legs = std::array<Leg, 3>;

std::optional<Legs> solveLegs(const Vec3& position_m) noexcept {
  Legs legs;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    const auto leg = solveLeg(position_m, kAzimuth_rad[i]);
    if (!leg) return std::nullopt;
    legs[i] = *leg;
  }
  return legs;
}

Vec3 computeAngles(const Legs& legs) noexcept {
  return {legs[0].angle_rad, legs[1].angle_rad, legs[2].angle_rad};
}

/// One row of d angle / d position. The rod has a constant length, so both of its ends have the
/// same speed along the rod.
Eigen::Vector3d jacobianRow(const Leg& leg, double azimuth_rad) noexcept {
  const double sin_knee =
      leg.sin_rod * std::cos(leg.angle_rad) - leg.cos_rod * std::sin(leg.angle_rad);
  const double lever_m = kArm_m * leg.sin_aside * sin_knee;
  const double ku = leg.cos_rod * leg.sin_aside / lever_m;
  const double kv = leg.cos_aside / lever_m;
  const double kw = leg.sin_rod * leg.sin_aside / lever_m;
  const double c = std::cos(azimuth_rad);
  const double s = std::sin(azimuth_rad);
  return {ku * c - kv * s, ku * s + kv * c, kw};
}

std::optional<Eigen::Matrix3d> computeJacobian(const Legs& legs) noexcept {
  Eigen::Matrix3d jacobian;
  for (std::size_t i = 0; i < legs.size(); ++i)
    jacobian.row(static_cast<Eigen::Index>(i)) = jacobianRow(legs[i], kAzimuth_rad[i]);
  if (!jacobian.allFinite() || !(std::abs(jacobian.determinant()) >= kLeastDeterminant))
    return std::nullopt;
  return jacobian;
}

}  // namespace

Vec3 falconAngles_rad(const std::array<int, 3>& encoders) noexcept {
  const Vec3 counts(encoders[0], encoders[1], encoders[2]);
  return Vec3::Constant(kZero_rad) + kRadPerCount * counts;
}

Vec3 falconEncoders(const Vec3& angles_rad) noexcept {
  return (angles_rad - Vec3::Constant(kZero_rad)) / kRadPerCount;
}

std::optional<Vec3> falconInverse_rad(const Vec3& position_m) noexcept {
  const auto legs = solveLegs(position_m);
  if (!legs) return std::nullopt;
  return computeAngles(*legs);
}

std::optional<Eigen::Matrix3d> falconJacobian_rad_m(const Vec3& position_m) noexcept {
  const auto legs = solveLegs(position_m);
  if (!legs) return std::nullopt;
  return computeJacobian(*legs);
}

std::optional<Vec3> falconForward_m(const Vec3& angles_rad, const Vec3& start_m) noexcept {
  Vec3 position_m = start_m;
  for (int i = 0; i < kMostSteps; ++i) {
    const auto legs = solveLegs(position_m);
    if (!legs) return std::nullopt;
    const Vec3 missing_rad = angles_rad - computeAngles(*legs);
    if (missing_rad.cwiseAbs().maxCoeff() <= kGood_rad) return position_m;
    const auto jacobian = computeJacobian(*legs);
    if (!jacobian) return std::nullopt;
    const Vec3 step_m = jacobian->inverse() * missing_rad;
    const double length_m = step_m.norm();
    position_m += length_m > kLongestStep_m ? Vec3(step_m * (kLongestStep_m / length_m)) : step_m;
  }
  return std::nullopt;
}

std::optional<Vec3> falconTorques(const Vec3& position_m, const Vec3& force_N) noexcept {
  const auto jacobian = falconJacobian_rad_m(position_m);
  if (!jacobian) return std::nullopt;
  // Principle of virtual work: torque · (J v) = force · v for every v.
  return Vec3(jacobian->inverse().transpose() * force_N);
}

std::array<int, 3> falconMotors(const Vec3& torques, double gain, int most) noexcept {
  Vec3 counts = -gain * torques;
  if (!counts.allFinite()) return {};
  const double largest = counts.cwiseAbs().maxCoeff();
  if (largest > most) counts *= most / largest;
  std::array<int, 3> motors{};
  for (std::size_t i = 0; i < motors.size(); ++i)
    motors[i] = static_cast<int>(std::lround(counts[static_cast<Eigen::Index>(i)]));
  return motors;
}

}  // namespace hapticast::client
