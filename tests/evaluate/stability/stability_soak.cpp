// SPDX-License-Identifier: MIT
// Ten minutes of random life, several seeds: the chain, the chain without its tank, the naive loop.
#include <algorithm>
#include <cmath>

#include "client/device/profile/device_profile.hpp"
#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/support/soak.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

struct Run {
  std::string profile;
  double stiffness_N_mm;
  const NamedHand* hand;
  unsigned seed;
  std::string variant;  // chain, no tank, naive
  LifeResult life{};
  PortWork work{};
  double user_mJ = 0.0, peak_N = 0.0, step_N = 0.0, excess_N = 0.0, allowed_N = 0.0;
  double true_excess_N = 0.0;
  std::uint64_t tank = 0, passivity = 0;
  bool finite = false;
};

void live(Run& run, int seconds) {
  PlantProfile profile = loadDeviceProfile(run.profile);
  profile.stiffness_N_mm = run.stiffness_N_mm;
  ChainFixture rig(profile, profile, run.hand->hand, {.tank = run.variant != "no tank"});
  rig.by_counts = run.variant == "naive";
  if (rig.by_counts) rig.law = bareLaw(0.0, profile.peak_N);
  run.life = Life(rig, run.seed).live(seconds);
  run.work = rig.chain.work();
  run.user_mJ = rig.true_work_mJ;
  run.peak_N = rig.max_force_N;
  run.step_N = rig.max_step_N;
  run.excess_N = rig.max_excess_N;
  run.true_excess_N = rig.max_true_excess_N;
  run.allowed_N = profile.peak_N;
  run.tank = rig.count(SafetyAction::kTank);
  run.passivity = rig.count(SafetyAction::kPassivity);
  run.finite = rig.finite;
}

std::vector<Run> runs() {
  std::vector<Run> all;
  for (const unsigned seed : {1U, 2U, 3U, 11U}) {
    for (const char* variant : {"chain", "no tank", "naive"})
      all.push_back({"omni", 1.0, &kHands[0], seed, variant});
  }
  for (const NamedHand& hand : kHands) {
    if (hand.hand.stiffness_N_m == 0.0) continue;
    for (const double k : {0.5, 1.0, 2.0, 5.0}) {
      for (const char* variant : {"chain", "naive"}) {
        all.push_back({"omni", k, &hand, 21, variant});
        if (k <= 2.0) all.push_back({"falcon", k, &hand, 31, variant});
      }
    }
  }
  return all;
}

}  // namespace

void stabilityLife(const StabilityReport& to) {
  const int seconds = to.options.quick ? 60 : 600;
  std::vector<Run> all = runs();
  onAllCores(all.size(), [&](std::size_t i) { live(all[i], seconds); });
  Table lines{{"device, hand, K, seed", "law", "peak N", "step max / p99.9 N", "W_user mJ", "W_rel",
               "W_surf", "W_obj", "burst mJ", "jumps, NaN", "tank %", "PC ticks", "alarms"}};
  double omni_mJ = -1e9;
  double falcon_mJ = -1e9;
  double excess_N = 0.0;
  double true_excess_N = 0.0;
  double soft_excess_N = 0.0;  // of it, at walls of 2 N/mm and less
  double over_N = -1e9;
  double burst_mJ = 0.0;
  double naive_burst_mJ = 1e9;
  double meter_off = 0.0;  // the meters beside the truth, of the work that goes through the ports
  bool finite = true;
  int alarms = 0;
  for (const Run& run : all) {
    const bool chain = run.variant == "chain";
    const bool metered = run.variant != "naive";
    const std::string name = text("%s %s K %g seed %u", run.profile.c_str(), run.hand->name,
                                  run.stiffness_N_mm, run.seed);
    const auto mJ = [&](double x) { return metered ? text("%.0f", x) : std::string("-"); };
    lines.push_back({name, run.variant, text("%.2f", run.peak_N),
                     text("%.2f / %.2f", run.step_N, run.life.step_p999_N),
                     text("%.0f", run.user_mJ), mJ(run.work.relative_mJ), mJ(run.work.surface_mJ),
                     mJ(run.work.object_mJ), text("%.1f", run.life.burst_mJ),
                     text("%d, %d", run.life.jumps, run.life.nans),
                     text("%.1f", double(run.tank) / (seconds * 10.0)),
                     text("%llu", static_cast<unsigned long long>(run.passivity)),
                     text("%d", run.life.alarms)});
    to.report.add({name, "life_burst", run.variant, run.life.burst_mJ, "mJ", 0.0, chain});
    if (run.profile == "omni" && !chain && run.variant == "naive")
      naive_burst_mJ = std::min(naive_burst_mJ, run.life.burst_mJ);
    if (!chain) continue;
    to.report.add({name, "life_unexplained_step", run.variant, run.true_excess_N, "N", 0.0, true});
    true_excess_N = std::max(true_excess_N, run.true_excess_N);
    if (run.stiffness_N_mm <= 2.0) soft_excess_N = std::max(soft_excess_N, run.true_excess_N);
    to.report.add({name, "life_relative_work", run.variant, run.work.relative_mJ, "mJ", 0.0, true});
    double& worst = run.profile == "omni" ? omni_mJ : falcon_mJ;
    if (run.stiffness_N_mm <= 2.0) worst = std::max(worst, run.work.relative_mJ);
    excess_N = std::max(excess_N, run.excess_N);
    const double through_mJ = run.work.surface_mJ - run.work.relative_mJ;
    meter_off = std::max(meter_off, std::abs(run.work.user_mJ() - run.user_mJ) / through_mJ);
    over_N = std::max(over_N, run.peak_N - run.allowed_N);
    if (run.profile == "omni") burst_mJ = std::max(burst_mJ, run.life.burst_mJ);
    finite = finite && run.finite;
    alarms += run.life.alarms;
  }
  const std::string what =
      text("%d s of random life, %zu runs of the chain", seconds, all.size() / 2);
  to.report.require(what + ": force finite and <= peak", "always",
                    finite && over_N <= 1e-9 ? "always" : "not always", finite && over_N <= 1e-9);
  to.report.require("random life: step_excess_max_N", "0", text("%g", excess_N), excess_N == 0.0);
  to.report.require("random life: largest step beyond K |dx| + B |dv| + S of the true HIP",
                    "<= 0.05 N", text("%.2f N", true_excess_N), true_excess_N <= 0.05);
  to.report.require("random life: that step, K <= 2", "<= 0.15 N", text("%.2f N", soft_excess_N),
                    soft_excess_N <= 0.15);
  to.report.require(
      "random life: the chain's meters off the true work, of the work through the ports", "<= 20 %",
      text("%.1f %%", 100.0 * meter_off), meter_off <= 0.2);
  to.report.require("random life: work at the relative port, Omni, K <= 2", "<= 0 mJ",
                    text("%.0f mJ at most", omni_mJ), omni_mJ <= 0.0);
  to.report.require("random life: work at the relative port, Falcon, K <= 2", "<= 30 mJ",
                    text("%.0f mJ at most", falcon_mJ), falcon_mJ <= 30.0);
  to.report.require("random life: most energy into the hand above 0.2 W (Omni)", "<= 23 mJ",
                    text("%.1f mJ; naive loop at least %.1f", burst_mJ, naive_burst_mJ),
                    burst_mJ <= 23.0);
  to.report.require("random life: alarms of the latency watch", "0", text("%d", alarms),
                    alarms == 0);
  to.report.addTable("life", lines);
}

}  // namespace hapticast::evaluate
