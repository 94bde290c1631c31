// SPDX-License-Identifier: MIT
#include <algorithm>
#include <stdexcept>

#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/held/held.hpp"
#include "tests/evaluate/held/held_measure.hpp"

namespace hapticast::evaluate {

namespace {

constexpr const char* kPart = "surface";

void reportScores(const std::vector<held::Recording>& recordings,
                  const std::vector<held::Scores>& all, Report& report) {
  Table lines{{"scene", "IoU mean", "relief share", "cut", "layer changes", "velocity error",
               "force noise", "ms/frame", "95 %"}};
  double unused = 0.0;
  double renamed = 0.0;
  double noise_N = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const held::Scores& s = all[i];
    const std::string& name = recordings[i].name;
    lines.push_back({name, text("%.3f", s.mean_iou), text("%.3f", s.relief_share),
                     text("%.3f", s.cut_share), text("%.4f", s.renamed),
                     s.velocity_error < 0 ? "rests" : text("%.3f", s.velocity_error),
                     s.noise_N < 0 ? "" : text("%.4f", s.noise_N), text("%.1f", s.median_ms),
                     text("%.1f", s.slow_ms)});
    const auto row = [&](const char* stage, double error, const char* unit) {
      report.add({name, stage, "true mask", error, unit, 0.0, true, false});
    };
    row("held: relief unused", 1.0 - s.relief_share, "share of 30 mm");
    row("held: relief cut", s.cut_share, "share of the pixels");
    row("held: layers renamed", s.renamed, "share of the pixels per frame");
    if (s.noise_N >= 0) row("held: rest", s.noise_N, "N rms");
    unused = std::max(unused, 1.0 - s.relief_share);
    renamed = std::max(renamed, s.renamed);
    noise_N = std::max(noise_N, s.noise_N);
  }
  report.addTable("surface", lines);
  report.add(Goal{"true masks: announced depth unused, worst scene", "share", 0.40, 0.15, unused});
  report.add(Goal{"true masks: pixels that change their layer, worst scene", "share per frame",
                  0.01, 0.0, renamed});
  report.add(Goal{"true masks: force noise at rest", "N", 0.01, 0.0, noise_N});
}

}  // namespace

void measureHeldSurfaces(const Options& options, Report& report) {
  const std::string part = std::string(kPart) + "/";
  const std::string only = options.only.rfind(part, 0) == 0 ? options.only.substr(part.size()) : "";
  std::vector<held::Scene> scenes;
  for (held::Scene& scene : held::heldScenes(options.set)) {
    if (scene.name.rfind(only, 0) == 0) scenes.push_back(std::move(scene));
  }
  if (scenes.empty())
    throw std::runtime_error("--only " + options.only + ": no held scene's name begins so");
  std::vector<held::Recording> recordings(scenes.size());
  std::vector<held::Scores> all(scenes.size());
  onAllCores(scenes.size(), [&](std::size_t i) {
    recordings[i] = held::record(scenes[i], {640, 480});
    all[i] = scoresOf(recordings[i], runVisionOnTrueMasks(recordings[i]));
    recordings[i].frames.clear();
    recordings[i].truth.clear();
  });
  reportScores(recordings, all, report);
}

}  // namespace hapticast::evaluate
