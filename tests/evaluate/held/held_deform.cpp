// SPDX-License-Identifier: MIT
#include <algorithm>
#include <stdexcept>

#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/held/deform_scores.hpp"
#include "tests/evaluate/held/held.hpp"

namespace hapticast::evaluate {

namespace {

using held::DeformScores;
using held::DepthSense;

struct DeformCase {
  const char* scene;
  DepthSense sense;
  const char* sensor;
};

// Objects that bend and squeeze, by exact depth and by two sensors; then rigid things, in hands and
// bare.
constexpr DeformCase kCases[] = {
    {"tube_bent", DepthSense::kExact, "exact"},
    {"tube_bent", DepthSense::kFlight, "flight"},
    {"ball_squeezed", DepthSense::kExact, "exact"},
    {"ball_squeezed", DepthSense::kStructured, "structured"},
    {"mug_turned", DepthSense::kExact, "exact"},
    {"mug_turned", DepthSense::kStructured, "structured"},
    {"mug_lifted", DepthSense::kFlight, "flight"},
    {"box_handed_over", DepthSense::kStructured, "structured"},
    {"bottle_turned", DepthSense::kFlight, "flight"},
    {"bear_carried", DepthSense::kStructured, "structured"},
    {"ball_hidden", DepthSense::kStructured, "structured"},
};

struct Measured {
  std::string name;
  DeformScores scores;
};

std::string orNothing(double value) { return value == -1.0 ? "" : text("%.3f", value); }

void reportDeforming(const std::vector<Measured>& all, Report& report) {
  Table lines{{"scene", "deformation", "told", "in the picture", "in depth", "frames looked at",
               "grid", "surface's velocity", "middle's velocity", "ms/frame"}};
  double unexplained = 0.0;
  double unseen = 0.0;
  double invented_mm_s = 0.0;
  double mug = 0.0;
  for (const Measured& scene : all) {
    const std::string& name = scene.name;
    const DeformScores& s = scene.scores;
    lines.push_back({name, s.deforms ? text("%.1f", s.apart_mm_s) : "rigid", orNothing(s.share),
                     orNothing(s.flat), orNothing(s.deep), text("%.2f", s.looked),
                     text("%.2f", s.grid_mm_s), orNothing(s.surface), orNothing(s.middle),
                     text("%.1f", s.median_ms)});
    const auto row = [&](const char* stage, double error, const char* unit) {
      report.add({name, stage, "true mask", error, unit, 1e3 * s.median_ms, true, false});
    };
    if (s.surface >= 0) row("deform: velocity of the surface", s.surface, "of the rms");
    if (s.middle >= 0) row("deform: velocity of the middle", s.middle, "of the rms");
    if (s.deforms) {
      row("deform: untold by the grid", 1.0 - s.share, "of the rms");
      row("deform: frames not looked at", 1.0 - s.looked, "share");
      unexplained = std::max(unexplained, 1.0 - s.share);
      unseen = std::max(unseen, 1.0 - s.looked);
      continue;
    }
    row("deform: grid of a rigid body", s.grid_mm_s, "mm/s rms");
    row("deform: frames with a grid of a rigid body", s.looked, "share");
    invented_mm_s = std::max(invented_mm_s, s.grid_mm_s);
    if (name.rfind("mug", 0) == 0) mug = std::max(mug, s.middle);
  }
  report.addTable("deform", lines);
  report.add(
      Goal{"deforming: untold by the grid, worst scene", "of the rms", 0.50, 0.20, unexplained});
  report.add(Goal{"deforming: frames not looked at, worst scene", "share", 0.20, 0.05, unseen});
  report.add(Goal{"deforming: grid of rigid bodies, worst scene", "mm/s", 1.0, 0.0, invented_mm_s});
  if (mug > 0) report.add(Goal{"deforming: velocity of a held mug", "share", 0.10, 0.03, mug});
}

}  // namespace

void measureDeforming(const Options& options, Report& report) {
  const std::string part = "deform/";
  const std::string only = options.only.rfind(part, 0) == 0 ? options.only.substr(part.size()) : "";
  std::vector<held::Scene> scenes;
  std::vector<Measured> all;
  for (const DeformCase& what : kCases) {
    const std::string name = what.scene;
    if (name.rfind(only, 0) != 0) continue;
    for (held::Scene& scene : held::heldScenes(options.set)) {
      if (scene.name != name) continue;
      scene.sensing.kind = what.sense;
      scene.sensing.flicker = 0.0;
      scenes.push_back(std::move(scene));
      all.push_back({name + "/" + what.sensor, {}});
    }
  }
  if (scenes.empty())
    throw std::runtime_error("--only " + options.only + ": no deforming scene's name begins so");
  onAllCores(scenes.size(), [&](std::size_t i) {
    const held::Recording recording = held::record(scenes[i], {640, 480});
    all[i].scores = deformScoresOf(recording, held::runVisionOnTrueMasks(recording));
  });
  reportDeforming(all, report);
}

}  // namespace hapticast::evaluate
