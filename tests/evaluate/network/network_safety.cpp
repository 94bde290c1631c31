// SPDX-License-Identifier: MIT
#include <algorithm>
#include <memory>

#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/network/network_parts.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace hapticast::evaluate {

namespace {

using client::HandKind;
using client::VirtualViewer;

// Stale data must not cause a force beyond this.
constexpr Duration kSilentAfter = std::chrono::milliseconds(500);
constexpr double kSeconds = 9.0;

struct BadNetwork {
  std::string name;
  Network network;
};

struct SafetyRun {
  const BadNetwork* bad;
  const NetworkScene* scene;
  HandKind kind;
  double excess_N = 0.0;
  double stale_N = 0.0;        // the strongest force when the newest data was too old
  double unexplained_N = 0.0;  // the largest step that the tip's own motion does not explain
  double contact = 0.0;        // share of ticks
  std::uint64_t stale_ticks = 0;
};

std::vector<BadNetwork> badNetworks(bool quick) {
  const Duration jitter = std::chrono::milliseconds(10);
  std::vector<BadNetwork> out;
  for (const bool udp : {true, false}) {
    const std::string by = udp ? "UDP, " : "TCP, ";
    const auto add = [&](const std::string& name, const testing::LinkProfile& link,
                         double cut_s = 0.0) {
      out.push_back({by + name, {udp, 0, link, 0.0, cut_s > 0.0 ? 4.0 : 1e9, cut_s}});
    };
    for (const double loss : {0.05, 0.2, 0.5}) {
      for (const double burst : {1.0, 5.0, 20.0}) {
        testing::LinkProfile link = farLink(jitter);
        link.loss = loss;
        link.burst = burst;
        if (!quick || burst == 5.0) add(text("%g %% lost, bursts of %g", 100 * loss, burst), link);
      }
    }
    testing::LinkProfile wild = farLink(std::chrono::milliseconds(60));
    wild.distribution = testing::Jitter::kExponential;
    wild.reorder = 0.3;
    wild.duplicate = 0.2;
    add("60 ms exponential jitter, 30 % overtaken, 20 % twice", wild);
    testing::LinkProfile narrow = farLink(jitter);
    narrow.rate_bits_s = 200e3;
    narrow.queue_bytes = 20000;
    add("200 kbit/s", narrow);
    for (const double cut_s : {0.1, 0.25, 0.6, 3.0}) {
      if (!quick || cut_s > 0.5) add(text("cut for %g s", cut_s), farLink(jitter), cut_s);
    }
  }
  return out;
}

void play(SafetyRun& run) {
  const client::HandScript script{run.kind, {}};
  VirtualViewer viewer(client::RendererSettings{}, client::PlantProfile{}, client::Hand::light(),
                       &script);
  double ticks = 0.0;
  (void)runSession(run.scene->stream, run.bad->network, kSeconds, viewer,
                   [&](const Wire& wire, const client::TickReport& report) {
                     ++ticks;
                     run.contact += report.contact ? 1.0 : 0.0;
                     run.excess_N = std::max(run.excess_N, report.step_excess_N);
                     if (report.play_time - wire.newest() < kSilentAfter) return;
                     ++run.stale_ticks;
                     run.stale_N = std::max(run.stale_N, report.force_N.norm());
                   });
  run.contact /= ticks;
  run.unexplained_N = viewer.trace.max_unexplained_N;
}

}  // namespace

void networkSafety(const std::vector<NetworkScene>& scenes, const Options& options,
                   Report& report) {
  const std::vector<BadNetwork> networks = badNetworks(options.quick);
  std::vector<SafetyRun> runs;
  for (const BadNetwork& bad : networks) {
    for (const NetworkScene& scene : scenes) {
      for (const HandKind kind : {HandKind::kPress, HandKind::kSlide, HandKind::kFollow})
        runs.push_back({&bad, &scene, kind});
    }
  }
  onAllCores(runs.size(), [&](std::size_t i) { play(runs[i]); });
  Table lines{{"network", "step beyond its limit, N", "force from stale data, N", "stale, s",
               "step not explained by the tip, N", "in contact"}};
  SafetyRun all{};
  for (const BadNetwork& bad : networks) {
    SafetyRun worst{};
    double count = 0.0;
    for (const SafetyRun& run : runs) {
      if (run.bad != &bad) continue;
      worst.excess_N = std::max(worst.excess_N, run.excess_N);
      worst.stale_N = std::max(worst.stale_N, run.stale_N);
      worst.unexplained_N = std::max(worst.unexplained_N, run.unexplained_N);
      worst.stale_ticks += run.stale_ticks;
      worst.contact += run.contact;
      ++count;
    }
    all.excess_N = std::max(all.excess_N, worst.excess_N);
    all.stale_N = std::max(all.stale_N, worst.stale_N);
    report.add({bad.name, "step_excess", "room", worst.excess_N, "N", 0.0, true, false});
    lines.push_back({bad.name, text("%.3g", worst.excess_N), text("%.3g", worst.stale_N),
                     text("%.1f", 1e-3 * double(worst.stale_ticks)),
                     text("%.3f", worst.unexplained_N),
                     text("%.0f %%", 100 * worst.contact / count)});
  }
  report.addTable("hand", lines);
  const std::string count = text(" (%zu runs)", runs.size());
  report.add(
      Goal{"any loss, jitter or cut: step_excess_max_N" + count, "N", 0.0, 0.0, all.excess_N});
  report.add(Goal{"force 500 ms after play time has passed the newest frame" + count, "N", 0.0, 0.0,
                  all.stale_N});
}

}  // namespace hapticast::evaluate
