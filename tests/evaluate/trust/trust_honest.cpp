// SPDX-License-Identifier: MIT
// The chain under honest streams: the scenes of the server, bodies in fast motion
// and the real clips, through vision and wire, with frames lost on the way, under every scripted
// hand.
#include <algorithm>
#include <filesystem>
#include <memory>

#include "client/haptics/safety/trust.hpp"
#include "tests/evaluate/stability/stability_parts.hpp"
#include "tests/evaluate/touch/stream_server.hpp"
#include "tests/evaluate/touch/touch_stream.hpp"
#include "tests/scenes/relief_scenes.hpp"
#include "tests/support/clips.hpp"
#include "tests/support/virtual_viewer.hpp"

namespace hapticast::evaluate {

namespace {

using namespace client;

struct HonestStream {
  std::string name;
  Stream stream;
};

std::vector<HonestStream> honestStreams(bool quick, Report& report) {
  std::vector<std::pair<std::string, std::function<Stream()>>> makers;
  const auto source = [&](const std::string& spec, const std::string& name) {
    makers.emplace_back(name, [spec] {
      const auto opened = server::openSource(spec, 0.0);
      return makeStream(*opened, {}, true);
    });
  };
  const auto scene = [&](const std::string& name, const std::function<TouchScene()>& make) {
    StreamKind kind;
    kind.scan = true;
    makers.emplace_back(name, [make, kind] { return makeStream(make(), kind); });
  };
  for (const server::SceneName& each : server::kSceneNames) {
    source("synthetic:" + std::string(each.name), std::string(each.name));
  }
  scene("sphere, 10 px a frame", [] { return movingSphere(10.0); });
  scene("sphere, 40 px a frame", [] { return movingSphere(40.0); });
  scene("plate, 5 mm at 1 Hz", [] { return swingingPlate(); });
  scene("dome that breathes", [] { return breathingDome(); });
  scene("ellipsoid that turns", [] { return spinningEllipsoid(); });
  scene("box that comes and goes", drivenBox);
  scene("ball that bounces", [] { return bouncingBall(1500.0, 0.6, 0.5); });
  if (!quick) {
    for (const char* clip : {"visp_rbt_desk", "dkvfx_typing_person", "tum_fr1_rpy"}) {
      const std::filesystem::path folder = test::clipsFolder() / clip;
      if (std::filesystem::exists(folder)) {
        source(folder.string(), clip);
      } else {
        report.leaveOut(clip);
      }
    }
  }
  std::vector<HonestStream> streams(makers.size());
  onAllCores(makers.size(), [&](std::size_t i) {
    streams[i] = {makers[i].first, makers[i].second()};
  });
  return streams;
}

/// A hand that stands still where things come by, and the scripts.
HandScript scriptOf(HandKind kind) {
  if (kind != HandKind::kFile) return {kind, {}};
  return {kind, {}, {{0.0, {0.0, 0.0, 8.0}}, {1000.0, {0.0, 0.0, 8.0}}}};
}

struct HonestRun {
  const HonestStream* stream;
  double lost;
  HandKind kind;
  client::Hand hand;
  client::ForceTrace trace;
  TickReport last;
};

void play(HonestRun& run) {
  const HandScript script = scriptOf(run.kind);
  auto viewer =
      std::make_unique<VirtualViewer>(RendererSettings{}, PlantProfile{}, run.hand, &script);
  StreamServer server(run.stream->stream, run.lost);
  run.last = runSession(server, *viewer, run.stream->stream.frames.back().time_s + 1.0);
  run.trace = std::move(viewer->trace);
}

/// The most of anything that one of several runs came to.
struct Worst {
  double doubted = 0.0, tank = 0.0, slew = 0.0;  // shares of ticks
  double score_ticks = 0.0, work_mJ = 0.0;
  int lost_trust = 0;
};

double share(const client::ForceTrace& trace, SafetyAction which) {
  return double(trace.ticksWith(bit(which))) / double(trace.safety_actions.size());
}

void take(Worst& worst, const HonestRun& run) {
  worst.doubted = std::max(worst.doubted, share(run.trace, SafetyAction::kImplausible));
  worst.tank = std::max(worst.tank, share(run.trace, SafetyAction::kTank));
  worst.slew = std::max(worst.slew, share(run.trace, SafetyAction::kSlew));
  worst.score_ticks = std::max(worst.score_ticks, run.trace.max_trust_score_ticks);
  worst.work_mJ = std::max(worst.work_mJ, run.trace.mostWork_mJ(10.0));
  worst.lost_trust += run.last.halt == Halt::kNone ? 0 : 1;
}

std::string percent(double share) { return text("%.2f %%", 100.0 * share); }

double mostSlewed(const std::vector<HonestRun>& runs, double lost) {
  double most = 0.0;
  for (const HonestRun& run : runs) {
    if (run.lost == lost) most = std::max(most, share(run.trace, SafetyAction::kSlew));
  }
  return most;
}

}  // namespace

void stabilityHonest(const StabilityReport& to) {
  const std::vector<HonestStream> streams = honestStreams(to.options.quick, to.report);
  std::vector<HonestRun> runs;
  for (const HonestStream& stream : streams) {
    for (const double lost : {0.0, 0.2}) {
      for (const HandKind kind :
           {HandKind::kPress, HandKind::kSlide, HandKind::kFollow, HandKind::kFile}) {
        runs.push_back({&stream, lost, kind, client::Hand::light(), {}, {}});
        if (!to.options.quick) runs.push_back({&stream, lost, kind, client::Hand::firm(), {}, {}});
      }
    }
  }
  onAllCores(runs.size(), [&](std::size_t i) { play(runs[i]); });
  Table lines{{"stream", "frames lost", "doubted", "tank", "slew",
               text("score, of %.0f", Trust::kMost_ticks), "mJ in 10 s"}};
  Worst all;
  for (std::size_t i = 0; i < runs.size();) {
    const HonestRun& first = runs[i];
    Worst worst;
    for (; i < runs.size() && runs[i].stream == first.stream && runs[i].lost == first.lost; ++i) {
      take(worst, runs[i]);
      take(all, runs[i]);
    }
    const std::string variant = text("%.0f %% lost", 100.0 * first.lost);
    to.report.add({first.stream->name, "trust", variant, worst.score_ticks, "ticks", 0.0, true});
    lines.push_back({first.stream->name, text("%.0f %%", 100.0 * first.lost),
                     percent(worst.doubted), percent(worst.tank), percent(worst.slew),
                     text("%.0f", worst.score_ticks), text("%.0f", worst.work_mJ)});
  }
  to.report.require(text("honest streams (%zu runs) that lose trust", runs.size()), "none",
                    text("%d", all.lost_trust), all.lost_trust == 0);
  to.report.require("honest streams: ticks doubted, worst run", "<= 0.1 %", percent(all.doubted),
                    all.doubted <= 1e-3);
  to.report.require("honest streams: ticks shortened by the tank, worst run", "<= 0.1 %",
                    percent(all.tank), all.tank <= 1e-3);
  for (const double lost : {0.0, 0.2}) {
    const double slewed = mostSlewed(runs, lost);
    const double most = lost > 0.0 ? 2e-3 : 1e-3;
    to.report.require(
        text("honest streams, %.0f %% lost: ticks limited in slew, worst run", 100.0 * lost),
        text("<= %s", percent(most).c_str()), percent(slewed), slewed <= most);
  }
  to.report.addTable("honest", lines);
}

}  // namespace hapticast::evaluate
