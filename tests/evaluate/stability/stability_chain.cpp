// SPDX-License-Identifier: MIT
// The safety chain: the rest of the sweep's impact for every allowed stiffness, and the rest with
// soft walls.
#include <algorithm>
#include <cmath>

#include "tests/evaluate/stability/stability_parts.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

struct ChainCell {
  int assumed, real;
  double stiffness_N_mm, friction_N, count_mm;
  const NamedHand* hand;
  double damping_Ns_m = 0.0;
  SweepResult result{};
  double excess_N = 0.0;
  std::uint64_t alarms = 0,
                insured = 0;  ///< ticks of oscillation detector and passivity controller
};

void runAll(std::vector<ChainCell>& cells, bool quick) {
  onAllCores(cells.size(), [&](std::size_t i) {
    ChainCell& c = cells[i];
    PlantProfile assumed = sweepProfile(c.stiffness_N_mm, c.assumed, c.friction_N);
    assumed.count_mm = c.count_mm;
    PlantProfile real = assumed;
    real.delay_ticks = c.real;
    ChainFixture rig(assumed, real, c.hand->hand);
    rig.damping_Ns_m = c.damping_Ns_m;
    c.result = sweepPlant(rig, c.hand->hand, quick);
    c.excess_N = rig.max_excess_N;
    c.alarms = rig.count(SafetyAction::kLatency);
    c.insured = rig.count(SafetyAction::kPassivity);
  });
}

std::vector<double> stiffnesses(int delay) {
  const double most = stiffnessLimit_N_mm(0.045, delay);
  std::vector<double> all;
  for (const double k : {0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0}) {
    if (k < 0.98 * most) all.push_back(k);
  }
  all.push_back(most);
  return all;
}

void residuals(const StabilityReport& to) {
  std::vector<ChainCell> cells;
  for (const int d : {0, 1, 2, 3, 5}) {
    for (const double k : stiffnesses(d)) {
      for (const NamedHand& hand : kHands) {
        for (const double friction_N : {0.0, 0.05}) {
          for (const double count_mm : {0.038, 0.055}) {
            cells.push_back({d, d, k, friction_N, count_mm, &hand});
          }
        }
      }
    }
  }
  runAll(cells, to.options.quick);
  for (const int d : {0, 1, 2, 3, 5}) {
    double worst = 0.0;
    for (const NamedHand& hand : kHands) {
      for (const double k : stiffnesses(d)) {
        double counts = 0.0;
        for (const ChainCell& c : cells) {
          if (c.assumed != d || c.hand != &hand || c.stiffness_N_mm != k) continue;
          counts = std::max(counts, c.result.counts(c.count_mm));
        }
        worst = std::max(worst, counts);
        const bool most = k == stiffnesses(d).back();
        to.report.add({text("d %d %s", d, hand.name), "residual",
                       most ? std::string("K_max") : text("K %g", k), counts, "counts", 0.0, true});
      }
    }
    to.report.require(
        text("chain on, every K <= K_max = %.2f N/mm, d %d, every hand and none, fc 0 and "
             "0.05 N, counts 0.038 and 0.055 mm: residual",
             stiffnesses(d).back(), d),
        "<= 2 counts", text("%.2f counts", worst), worst <= 2.0);
  }
  double excess_N = 0.0;
  std::size_t held = 0;
  std::size_t alarmed = 0;
  std::size_t insured = 0;
  for (const ChainCell& c : cells) {
    excess_N = std::max(excess_N, c.excess_N);
    held += c.result.released ? 0 : 1;
    alarmed += c.alarms > 0;
    insured += c.insured > 0;
  }
  to.report.require("chain on: step beyond what the hand explains", "0 N", text("%g N", excess_N),
                    excess_N == 0.0);
  to.report.require("chain on: runs with a force after the hand has left", "0", text("%zu", held),
                    held == 0);
  const double percent = 100.0 * double(alarmed) / double(cells.size());
  to.report.require("chain on: runs with a false alarm of the latency watch", "<= 1.3 %",
                    text("%zu of %zu", alarmed, cells.size()), percent <= 1.3);
  to.report.add(
      {text("%zu runs", cells.size()), "passivity_controller", "acts", double(insured), "runs"});
}

void softWalls(const StabilityReport& to) {
  double least = 1e9;
  double most = 0.0;
  double work_mJ = -1e9;
  double late_mJ = -1e9;
  std::vector<ChainCell> cells;
  for (const int d : {0, 1, 2, 3}) {
    for (const double k : {0.5, 1.0}) {
      for (const NamedHand& hand : kHands) cells.push_back({d, d, k, 0.0, 0.055, &hand});
    }
  }
  runAll(cells, false);
  for (const ChainCell& c : cells) {
    least = std::min(least, c.result.kept);
    most = std::max(most, c.result.kept);
    double& worst_mJ = c.assumed <= 1 ? work_mJ : late_mJ;
    worst_mJ = std::max(worst_mJ, c.result.work_mJ);
  }
  to.report.require("walls of 0.5 and 1 N/mm, d 0-3: rendered stiffness", "100 %",
                    text("%.1f-%.1f %%", 100.0 * least, 100.0 * most),
                    least >= 0.99 && most <= 1.01);
  to.report.require("walls of 0.5 and 1 N/mm, d 0-1: work into the hand over the whole contact",
                    "<= 0 mJ", text("%.2f mJ at most", work_mJ), work_mJ <= 0.0);
  to.report.add({"walls of 0.5 and 1 N/mm, d 2-3, 9 s", "work_into_hand", "chain", late_mJ, "mJ"});
}

/// Assumed one delay, really another; and an author's damping at its bound.
void wrongDelays(const StabilityReport& to) {
  std::vector<ChainCell> cells;
  for (const int assumed : {0, 1, 2}) {
    for (const int off : {-1, 0, 1, 2}) {
      if (assumed + off < 0) continue;
      for (const double k : {0.5, 1.0, 2.0, 5.0}) {
        for (const NamedHand& hand : kHands)
          cells.push_back({assumed, assumed + off, k, 0.05, 0.055, &hand});
      }
    }
  }
  runAll(cells, to.options.quick);
  for (const ChainCell& c : cells) {
    to.report.add({text("told %d real %d %s", c.assumed, c.real, c.hand->name),
                   "residual_wrong_delay", text("K %g", c.stiffness_N_mm),
                   c.result.counts(c.count_mm), "counts"});
  }
  std::vector<ChainCell> damped;
  for (const int d : {0, 1, 2, 3, 5}) {
    for (const double k : stiffnesses(d)) {
      for (const NamedHand& hand : kHands) damped.push_back({d, d, k, 0.0, 0.055, &hand, 1e9});
    }
  }
  runAll(damped, to.options.quick);
  double worst = 0.0;
  for (const ChainCell& c : damped) {
    worst = std::max(worst, c.result.counts(c.count_mm));
  }
  to.report.require("an author's damping of any size (bounded by the chain), all K and d: residual",
                    "<= 2 counts", text("%.2f counts", worst), worst <= 2.0);
}

}  // namespace

void stabilityChain(const StabilityReport& to) {
  residuals(to);
  softWalls(to);
  wrongDelays(to);
}

}  // namespace hapticast::evaluate
