// SPDX-License-Identifier: MIT
// The simulated limits of stability against the formulas: without friction and counts
// (b + B) / (T/2 + td), with friction the basin of attraction.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/time.hpp"

#include "tests/evaluate/stability/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

using client::AxisPlant;
using client::Hand;
using client::PlantProfile;

constexpr double kSmallPhase = 0.55;

PlantProfile device(double damping_Ns_m, double friction_N) {
  PlantProfile profile;
  profile.damping_Ns_m = damping_Ns_m;
  profile.friction_N = friction_N;
  return profile;
}

/// Largest factor of `guess` that is stable, by bisection on a logarithmic scale.
template <class Stable>
double criticalFactor(Stable stable) {
  double low = 1.0 / 64.0;
  double high = 64.0;
  if (!stable(low)) return 0.0;
  for (int i = 0; i < 22; ++i) {
    const double middle = std::sqrt(low * high);
    (stable(middle) ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

/// A bilateral spring with a damper on the raw difference, no friction, no counts, no hand: does
/// the swing shrink?
bool shrinks(double b, double B, double stiffness_N_m, int delay) {
  AxisPlant plant(device(b, 0.0), Hand::none());
  plant.reset(1e-3, 0.0);
  double sent_N[8] = {};
  double last_m = 1e-3;
  double early = 0.0;
  double late = 0.0;
  const double period_s = 2.0 * std::numbers::pi * std::sqrt(kOmniMass_kg / stiffness_N_m);
  const int ticks = std::max(4000, static_cast<int>(40.0 * period_s / kTick_s));
  for (int i = 0; i < ticks; ++i) {
    const double x_m = plant.position_m();
    const double force_N = -stiffness_N_m * x_m - B * (x_m - last_m) / kTick_s;
    last_m = x_m;
    for (int j = 7; j > 0; --j) sent_N[j] = sent_N[j - 1];
    sent_N[0] = force_N;
    plant.advance(sent_N[delay], 0.0, 0.0);
    const double energy =
        stiffness_N_m * x_m * x_m + kOmniMass_kg * plant.velocity_m_s() * plant.velocity_m_s();
    if (!(energy < 1e6)) return false;
    if (i >= ticks / 4 && i < ticks / 2) early += energy;
    if (i >= ticks * 3 / 4) late += energy;
  }
  return late < early;
}

/// A counted raw spring wall with friction, pushed with 1 N, let go `start_mm` off rest: at rest
/// after 7.5 s?
bool comesToRest(double b, double friction_N, double stiffness_N_m, int delay, double start_mm) {
  constexpr double kCount_m = 55e-6;
  AxisPlant plant(device(b, friction_N), Hand::none());
  const double rest_m = -1.0 / stiffness_N_m;
  plant.reset(rest_m + start_mm * 1e-3, 0.0);
  double sent_N[8];
  std::fill(std::begin(sent_N), std::end(sent_N), 1.0);
  double low_m = 1e9;
  double high_m = -1e9;
  for (int i = 0; i < 7500; ++i) {
    const double x_m = std::round(plant.position_m() / kCount_m) * kCount_m;
    for (int j = 7; j > 0; --j) sent_N[j] = sent_N[j - 1];
    sent_N[0] = std::max(0.0, -stiffness_N_m * x_m);
    plant.advance(sent_N[delay] - 1.0, 0.0, 0.0);
    if (i < 7250) continue;
    low_m = std::min(low_m, plant.position_m());
    high_m = std::max(high_m, plant.position_m());
  }
  return high_m - low_m < kCount_m;
}

/// K of (K (T/2+td) - b) sqrt(K/m) = 4 fc / (pi a), N/m.
double basin_N_m(double b, double friction_N, int delay, double start_mm) {
  const double right = 4.0 * friction_N / (std::numbers::pi * start_mm * 1e-3);
  double low = b / ((0.5 + delay) * kTick_s);
  double high = 1e6;
  for (int i = 0; i < 80; ++i) {
    const double k = 0.5 * (low + high);
    const double left = (k * (0.5 + delay) * kTick_s - b) * std::sqrt(k / kOmniMass_kg);
    (left < right ? low : high) = k;
  }
  return low;
}

struct TheoryCell {
  double b, B, friction_N, start_mm;
  int delay;
  double ratio = 0.0;
};

std::string scene(const TheoryCell& c) {
  return c.friction_N > 0.0 ? text("b %g fc %g a %g", c.b, c.friction_N, c.start_mm)
                            : text("b %g B %g", c.b, c.B);
}

void linear(const StabilityReport& to) {
  std::vector<TheoryCell> cells;
  for (const double B : {0.0, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0}) {
    for (const double b : {0.05, 0.1, 0.2, 0.5, 1.0}) {
      if (B > 0.0 && b != 0.1) continue;
      for (const int d : {0, 1, 2, 3, 4, 5}) cells.push_back({b, B, 0.0, 0.0, d});
    }
  }
  onAllCores(cells.size(), [&](std::size_t i) {
    TheoryCell& c = cells[i];
    const double theory_N_m = (c.b + c.B) / ((0.5 + c.delay) * kTick_s);
    c.ratio = criticalFactor([&](double f) { return shrinks(c.b, c.B, f * theory_N_m, c.delay); });
  });
  double worst = 0.0;
  for (const TheoryCell& c : cells) {
    to.report.add({scene(c), "limit_over_theory", text("d %d", c.delay), c.ratio, "ratio"});
    if (c.B == 0.0) worst = std::max(worst, std::abs(c.ratio - 1.0));
  }
  to.report.require("undamped, unquantised limit against b/(T/2+td), b 0.05-1, d 0-5", "within 2 %",
                    text("within %.1f %%", 100.0 * worst), worst <= 0.0205);
}

void basin(const StabilityReport& to) {
  std::vector<TheoryCell> cells;
  for (const double b : {0.1, 0.2, 0.5}) {
    for (const double friction_N : {0.05, 0.1, 0.26}) {
      for (const double start_mm : {0.1, 0.2, 0.3, 2.0}) {
        for (const int d : {0, 1, 2, 3}) cells.push_back({b, 0.0, friction_N, start_mm, d});
      }
    }
  }
  onAllCores(cells.size(), [&](std::size_t i) {
    TheoryCell& c = cells[i];
    const double theory_N_m = basin_N_m(c.b, c.friction_N, c.delay, c.start_mm);
    c.ratio = criticalFactor([&](double f) {
      return comesToRest(c.b, c.friction_N, f * theory_N_m, c.delay, c.start_mm);
    });
  });
  std::vector<double> ratios;
  std::size_t within = 0;
  for (const TheoryCell& c : cells) {
    const double theory_N_m = basin_N_m(c.b, c.friction_N, c.delay, c.start_mm);
    to.report.add({scene(c), "limit_over_basin", text("d %d", c.delay), c.ratio, "ratio"});
    const double phase = std::sqrt(theory_N_m / kOmniMass_kg) * (0.5 + c.delay) * kTick_s;
    if (c.start_mm * 1e-3 > 1.0 / theory_N_m) continue;  // the tip leaves the wall at once
    if (phase > kSmallPhase) continue;
    ratios.push_back(c.ratio);
    within += std::abs(c.ratio - 1.0) <= 0.15;
  }
  std::sort(ratios.begin(), ratios.end());
  to.report.require(
      "amplitude-dependent limit with friction, counts of 0.055 mm, where the theory applies",
      "within 15 %",
      text("median ratio %.2f, %zu of %zu within 15 %%, range %.2f-%.2f", ratios[ratios.size() / 2],
           within, ratios.size(), ratios.front(), ratios.back()),
      within == ratios.size());
}

}  // namespace

void stabilityTheory(const StabilityReport& to) {
  linear(to);
  basin(to);
}

}  // namespace hapticast::evaluate
