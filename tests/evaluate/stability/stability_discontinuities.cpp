// SPDX-License-Identifier: MIT
// Discontinuities of stream and machine under a hand that presses on a still plate: the energy that
// they put into the hand, and the share of the contact that the account removes.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "client/haptics/safety/wall_law.hpp"
#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/support/press_bench.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

constexpr double kTouched_s = 3.0;  // the hand presses by then, and rests
constexpr double kEnd_s = 15.0;

/// A kind of discontinuity. `act` prepares each tick. Its arguments are the time since the last
/// discontinuity, the same as a share of the period, and the number of discontinuities so far.
struct Discontinuity {
  const char* name;
  void (*act)(PressBench& bench, double since_s, double phase, int count);
  bool honest = false;
};

using Frame = PlayFrame;

constexpr Discontinuity kKinds[] = {
    {"two ids in turn",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) { b.add(f, static_cast<std::uint32_t>(1 + n % 2)); };
     }},
    {"a new id",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) { b.add(f, static_cast<std::uint32_t>(1 + n)); };
     }},
    {"absent for 40 %",
     [](PressBench& b, double, double phase, int) {
       const bool there = phase < 0.6;
       b.scene = [&b, there](Frame& f, double) {
         if (there) b.add(f, 1);
       };
     }},
    {"the layer changes",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) {
         b.add(f, 1).layer = static_cast<std::uint32_t>(n % 2);
       };
     }},
    {"a new epoch",
     [](PressBench& b, double, double, int n) { b.epoch = 1 + static_cast<std::uint32_t>(n); },
     true},
    {"a seek: 0.15 s without frames, a new epoch",
     [](PressBench& b, double since_s, double, int n) {
       b.epoch = 1 + static_cast<std::uint32_t>(n);
       b.streaming = since_s > 0.15 || n == 0;
     },
     true},
    {"a takeover",
     [](PressBench& b, double, double phase, int n) {
       b.epoch = 1 + static_cast<std::uint32_t>(n);
       b.stream.connected = phase > 0.02 || n == 0;
       b.stream.first_epoch = b.epoch;
     }},
    {"another workspace", [](PressBench& b, double, double,
                             int n) { b.stream.workspace.width_mm = n % 2 == 0 ? 160.0 : 168.0; }},
    {"no frames for half of the time",
     [](PressBench& b, double, double phase, int) { b.streaming = phase < 0.5; }},
    {"0.3 mm up, 0.3 mm down under a new id",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) {
         b.add(f, static_cast<std::uint32_t>(1 + n), PressBench::kPlate_mm + 0.35 * (n % 2));
       };
     }},
    {"the stiffness 0.05 and 1.5 N/mm",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) {
         b.add(f, 1).material.stiffness_N_mm = n % 2 ? 1.5 : 0.05;
       };
     }},
    {"the user's pause",
     [](PressBench& b, double, double phase, int) { b.user.paused = phase > 0.7; }},
    {"re-arming",
     [](PressBench& b, double, double, int n) { b.user.rearm = static_cast<std::uint32_t>(n); }},
};

/// Surfaces that move: only the meters are compared with the truth.
constexpr Discontinuity kMoving[] = {
    {"1 mm up and down",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) { b.add(f, 1, PressBench::kPlate_mm + n % 2); };
     }},
    {"5 mm up and down",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) { b.add(f, 1, PressBench::kPlate_mm + 5 * (n % 2)); };
     }},
    {"1 mm up and down under a new id",
     [](PressBench& b, double, double, int n) {
       b.scene = [&b, n](Frame& f, double) {
         b.add(f, static_cast<std::uint32_t>(1 + n), PressBench::kPlate_mm + n % 2);
       };
     }},
    {"3 mm up and absent",
     [](PressBench& b, double, double phase, int n) {
       const bool there = phase < 0.7;
       b.scene = [&b, there, n](Frame& f, double) {
         if (there) b.add(f, 1, PressBench::kPlate_mm + 3 * (n % 2));
       };
     }},
};

struct DiscontinuityRun {
  const Discontinuity* kind = nullptr;
  double per_s = 1.0;
  int late_ms = 0;  // of a machine that is late, instead of a kind
  PressSetup setup;
  bool moving = false;  // a kind of kMoving
  double work_mJ = 0.0;
  double done_mJ = 0.0;     // at the end
  double metered_mJ = 0.0;  // the same by the client's meters
  double silent = 0.0;
  double peak_N = 0.0;
  bool finite = true;
  double score = 0.0;
  bool trusted = true;
};

void press(DiscontinuityRun& run, double seconds) {
  auto bench = std::make_unique<PressBench>(run.setup);
  double next_s = kTouched_s;
  while (bench->time_s < seconds) {
    const double since_s = bench->time_s - kTouched_s;
    int ms = 1;
    if (since_s >= 0.0 && run.kind != nullptr) {
      const double turns = since_s * run.per_s;
      const double phase = turns - std::floor(turns);
      run.kind->act(*bench, phase / run.per_s, phase, static_cast<int>(turns));
    } else if (since_s >= 0.0 && bench->time_s >= next_s) {
      ms = run.late_ms;
      next_s += 1.0 / run.per_s;
    }
    const TickReport& report = bench->step(ms);
    run.trusted = run.trusted && report.halt != Halt::kTrustLost;
    run.score = std::max(run.score, report.trust_score_ticks);
  }
  run.work_mJ = bench->mostWork_mJ(kTouched_s, run.kind != nullptr ? 10.0 : 6.0);
  run.silent = double(bench->silent_ticks) / double(std::max<std::size_t>(1, bench->contact_ticks));
  run.peak_N = bench->peak_N;
  run.finite = bench->finite;
  run.done_mJ = bench->work_mJ.back();
  run.metered_mJ = bench->renderer->report().work.user_mJ();
}

/// Draws a device in a hand that presses with up to 3 N.
PressSetup drawSetup(std::mt19937& random) {
  const auto draw = [&random](double from, double to) {
    return std::exp(std::uniform_real_distribution(std::log(from), std::log(to))(random));
  };
  PressSetup setup;
  setup.profile.delay_ticks = setup.delay_ticks = static_cast<int>(random() % 3);
  const double stiffest_N_mm = stiffnessLimit_N_mm(setup.profile);
  setup.stiffness_N_mm = draw(0.3, stiffest_N_mm);
  setup.hand_kg = draw(0.05, 1.0);
  setup.hand_N_mm = draw(0.1, 0.8);
  setup.hand_Ns_m = 2.0 * draw(0.3, 0.8) * std::sqrt(setup.hand_N_mm * 1e3 * setup.hand_kg);
  setup.friction_N = random() % 2 == 0 ? 0.05 : 0.0;
  setup.depth_mm = draw(0.5, 3.0) * (1.0 / setup.hand_N_mm + 1.0 / setup.stiffness_N_mm);
  return setup;
}

void addClaims(Report& report, const std::vector<DiscontinuityRun>& runs) {
  double most_mJ = 0.0;
  double late_mJ = 0.0;
  double silent = 0.0;  // of a clip of 4 s and of a seek in every 5 s
  double peak_N = 0.0;
  bool finite = true;
  int distrusted_late = 0;
  int misread = 0;
  double off_mJ = 0.0;
  for (const DiscontinuityRun& run : runs) {
    const double error_mJ = std::abs(run.metered_mJ - run.done_mJ);
    misread += error_mJ > std::max(2.0, 0.05 * std::abs(run.done_mJ)) ? 1 : 0;
    off_mJ = std::max(off_mJ, error_mJ);
    peak_N = std::max(peak_N, run.peak_N);
    finite = finite && run.finite;
    if (run.kind == nullptr) {
      late_mJ = std::max(late_mJ, run.work_mJ);
      distrusted_late += run.trusted ? 0 : 1;
      continue;
    }
    if (run.moving) continue;
    most_mJ = std::max(most_mJ, run.work_mJ);
    if (run.kind->honest && run.per_s <= 0.25) silent = std::max(silent, run.silent);
  }
  report.require("discontinuities at a still plate: energy into a pressing hand in any 10 s",
                 "<= 20 mJ (aim 10)", text("%.1f mJ", most_mJ), most_mJ <= 20.0);
  report.require("late ticks of 5 to 50 ms at 1 to 10 /s: energy in any 6 s", "<= 15 mJ (aim 5)",
                 text("%.1f mJ", late_mJ), late_mJ <= 15.0);
  report.require("late ticks: streams that lose trust", "none", text("%d", distrusted_late),
                 distrusted_late == 0);
  report.require("a clip of 4 s, a seek each 5 s: contact without force", "<= 5 % (aim 1)",
                 text("%.1f %%", 100.0 * silent), silent <= 0.05);
  report.require("discontinuities: runs whose meters are off by more than 5 % and 2 mJ",
                 "<= 1 % (aim 0)", text("%d of %zu, %.1f mJ at most", misread, runs.size(), off_mJ),
                 100 * misread <= static_cast<int>(runs.size()));
  report.require("discontinuities: largest force", "<= 3.3 N", text("%.2f N", peak_N),
                 finite && peak_N <= 3.3 + 1e-9);
}

}  // namespace

void stabilityDiscontinuities(const StabilityReport& to) {
  std::mt19937 random(static_cast<unsigned>(to.options.set));
  std::vector<DiscontinuityRun> runs;
  const int draws = to.options.quick ? 2 : 12;
  for (int draw = 0; draw < draws; ++draw) {
    for (const Discontinuity& kind : kKinds) {
      for (const double per_s : {0.2, 0.25, 0.5, 0.8, 1.1, 2.0, 3.0, 5.0, 8.0, 16.0, 50.0}) {
        DiscontinuityRun run{&kind, per_s, 0, drawSetup(random)};
        run.setup.frames_per_s = std::max(25.0, 2.5 * per_s);
        runs.push_back(run);
      }
    }
    for (const Discontinuity& kind : kMoving) {
      for (const double per_s : {2.0, 5.0, 12.0, 25.0, 50.0, 100.0}) {
        DiscontinuityRun run{&kind, per_s, 0, drawSetup(random)};
        run.moving = true;
        run.setup.frames_per_s = std::max(25.0, per_s);
        runs.push_back(run);
      }
    }
    for (const int late_ms : {5, 10, 15, 19, 21, 30, 50}) {
      for (const double per_s : {1.0, 2.0, 5.0, 10.0})
        runs.push_back({nullptr, per_s, late_ms, drawSetup(random)});
    }
  }
  onAllCores(runs.size(), [&](std::size_t i) { press(runs[i], kEnd_s); });
  addClaims(to.report, runs);
  Table lines{{"discontinuity", "per s", "delay", "K N/mm", "hand kg", "hand N/mm", "friction N",
               "depth mm", "mJ", "done mJ", "metered mJ", "no force %", "peak N", "trust",
               "score"}};
  for (const DiscontinuityRun& run : runs) {
    lines.push_back({run.kind != nullptr ? run.kind->name : text("%d ms late", run.late_ms),
                     text("%g", run.per_s), text("%d", run.setup.delay_ticks),
                     text("%.2f", run.setup.stiffness_N_mm), text("%.2f", run.setup.hand_kg),
                     text("%.2f", run.setup.hand_N_mm), text("%g", run.setup.friction_N),
                     text("%.1f", run.setup.depth_mm), text("%.1f", run.work_mJ),
                     text("%.2f", run.done_mJ), text("%.2f", run.metered_mJ),
                     text("%.1f", 100.0 * run.silent), text("%.2f", run.peak_N),
                     run.trusted ? "kept" : "lost", text("%.0f", run.score)});
  }
  to.report.addTable("discontinuities", lines);
}

}  // namespace hapticast::evaluate
