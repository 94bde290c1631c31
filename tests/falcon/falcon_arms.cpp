// SPDX-License-Identifier: MIT
#include "tests/falcon/falcon_arms.hpp"

#include <array>
#include <cmath>

namespace hapticast::testing {

namespace {

// As published by open drivers, in their own form: degrees and mm.
constexpr std::array<double, 3> kLegs_deg = {105.0, -15.0, -135.0};
constexpr double kCount_deg = 0.0364347;
constexpr double kFirst_deg = 35.0;
constexpr double kThigh_mm = 60.0;
constexpr double kSide_mm = 102.5;
constexpr double kEnds_mm = 11.25 + 11.25;
constexpr double kPi = 3.14159265358979323846;

/// How much too long the rod of a leg would have to be, mm².
double openLoop(double out_mm, double up_mm, double rod_mm, double angle) {
  const double u = out_mm - kThigh_mm * std::cos(angle);
  const double w = up_mm - kThigh_mm * std::sin(angle);
  return u * u + w * w - rod_mm * rod_mm;
}

double legAngle(const Vec3& position_m, double leg_deg) {
  const Vec3 p = 1e3 * position_m;
  const double turn = leg_deg * kPi / 180.0;
  const double out_mm = std::cos(turn) * p.x() + std::sin(turn) * p.y() - 40.0 + 14.43;
  const double aside_mm = std::cos(turn) * p.y() - std::sin(turn) * p.x() + 23.09 - 25.0;
  const double rod_mm = kEnds_mm + std::sqrt(kSide_mm * kSide_mm - aside_mm * aside_mm);
  // The knee is below the line from the hip to the grip: between them the distance only falls.
  double near = std::atan2(p.z(), out_mm);
  double far = near - kPi;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (near + far);
    (openLoop(out_mm, p.z(), rod_mm, middle) > 0.0 ? far : near) = middle;
  }
  return 0.5 * (near + far);
}

}  // namespace

Vec3 encodersAt(const Vec3& position_m) {
  Vec3 counts;
  for (int leg = 0; leg < 3; ++leg)
    counts[leg] = (legAngle(position_m, kLegs_deg[static_cast<std::size_t>(leg)]) * 180.0 / kPi -
                   kFirst_deg) /
                  kCount_deg;
  return counts;
}

Vec3 forceAt_N(const Vec3& position_m, const Vec3& motors, double gain) {
  constexpr double kStep_m = 1e-5;
  Vec3 force_N = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 step_m = kStep_m * Vec3::Unit(axis);
    for (int leg = 0; leg < 3; ++leg) {
      const double deg = kLegs_deg[static_cast<std::size_t>(leg)];
      // Virtual work: a positive motor count turns its arm back.
      const double rate =
          (legAngle(position_m + step_m, deg) - legAngle(position_m - step_m, deg)) /
          (2.0 * kStep_m);
      force_N[axis] -= motors[leg] / gain * rate;
    }
  }
  return force_N;
}

}  // namespace hapticast::testing
