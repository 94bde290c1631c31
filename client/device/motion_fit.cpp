// SPDX-License-Identifier: MIT
#include "client/device/motion_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/time.hpp"

namespace hapticast::client {

namespace {
using Column = Eigen::VectorXd;
using Index = Eigen::Index;

constexpr double kSlowest_mm_s = 5.0;  // chosen: below, the counts decide the sign of the speed
constexpr Index kSmooth_ticks = 3;

/// Integrates an acceleration (m/s², constant within each tick) twice. Returns mm.
Column integrateTwice(const Column& acceleration_m_s2) {
  Column way_mm = Column::Zero(acceleration_m_s2.size());
  double speed_mm_s = 0.0;
  for (Index k = 0; k + 1 < way_mm.size(); ++k) {
    const double change_mm_s = 1e3 * acceleration_m_s2[k] * kTick_s;
    way_mm[k + 1] = way_mm[k] + kTick_s * (speed_mm_s + 0.5 * change_mm_s);
    speed_mm_s += change_mm_s;
  }
  return way_mm;
}

/// Returns the sign of the speed in each tick; 0 at rest.
Column computeSigns(const Column& position_mm) {
  const Index last = position_mm.size() - 1;
  Column signs = Column::Zero(position_mm.size());
  for (Index k = 0; k <= last; ++k) {
    const Index from = std::max<Index>(0, k - kSmooth_ticks);
    const Index to = std::min(last, k + kSmooth_ticks);
    const double way_mm = position_mm[to] - position_mm[from];
    const double speed_mm_s = way_mm / (static_cast<double>(to - from) * kTick_s);
    if (std::abs(speed_mm_s) > kSlowest_mm_s) signs[k] = speed_mm_s > 0.0 ? 1.0 : -1.0;
  }
  return signs;
}

/// Returns the way that a damper of 1 N·s/m would take from a mass of 1 kg, mm.
Column integrateWay(const Column& position_mm) {
  Column way_mm = Column::Zero(position_mm.size());
  for (Index k = 0; k + 1 < way_mm.size(); ++k)
    way_mm[k + 1] =
        way_mm[k] - kTick_s * (0.5 * (position_mm[k] + position_mm[k + 1]) - position_mm[0]);
  return way_mm;
}
}  // namespace

MotionFit fitMotion(std::span<const double> force_N, std::span<const double> position_mm) {
  const auto count = static_cast<Index>(position_mm.size());
  const Column way_mm = Eigen::Map<const Column>(position_mm.data(), count);
  const Column force = Eigen::Map<const Column>(force_N.data(), count);
  const Column time_s = Column::LinSpaced(count, 0.0, static_cast<double>(count - 1) * kTick_s);
  Eigen::MatrixXd terms(count, 5);
  terms.col(0).setOnes();
  terms.col(1) = time_s.cwiseAbs2();
  terms.col(2) = integrateWay(way_mm);
  terms.col(3) = -integrateTwice(computeSigns(way_mm));
  MotionFit best;
  best.residual_mm = std::numeric_limits<double>::infinity();
  for (int delay = 0; delay <= kMostFittedDelay_ticks; ++delay) {
    Column acting_N = Column::Zero(count);
    acting_N.tail(count - delay) = force.head(count - delay);
    terms.col(4) = integrateTwice(acting_N);
    const Column solution = terms.colPivHouseholderQr().solve(way_mm);
    const double residual_mm =
        std::sqrt((terms * solution - way_mm).squaredNorm() / static_cast<double>(count));
    if (!(residual_mm < best.residual_mm)) continue;
    const double mass_kg = solution[4] != 0.0 ? 1.0 / solution[4] : 0.0;
    best = {.mass_kg = mass_kg, .delay_ticks = delay, .residual_mm = residual_mm};
  }
  return best;
}

}  // namespace hapticast::client
