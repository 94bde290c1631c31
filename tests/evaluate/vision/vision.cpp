// SPDX-License-Identifier: MIT
// Masks of every segmenter, reliefs of every enhancement and what they cost, against exact truth;
// then the real clips.
#include <algorithm>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>

#include "tests/evaluate/held/held.hpp"
#include "tests/evaluate/topics.hpp"
#include "tests/evaluate/vision/vision_parts.hpp"
#include "tests/evaluate/vision/vision_run.hpp"
#include "tests/evaluate/vision/vision_sheet.hpp"

namespace hapticast::evaluate {

namespace {

struct Variant {
  const char* name;
  server::SegmentMode mode;
  Method method = Method::kHapticast;
  bool is_default = false;
  bool is_thesis = false;
};
const Variant kVariants[] = {
    {"band", server::SegmentMode::kBand, Method::kHapticast, true, false},
    {"edges", server::SegmentMode::kEdges, Method::kThesis, false, true},
    {"source", server::SegmentMode::kSource},
};

// Mean and worst over scenes, by stage, variant and sensor.
class Summary {
 public:
  explicit Summary(Report& report) : report_(report) {}

  void add(const Row& row, const std::string& group) {
    report_.add(row);
    groups_[{row.stage, row.variant, "mean"}].push_back(row);
    groups_[{row.stage, row.variant, "mean " + group}].push_back(row);
  }

  void finish() {
    for (const auto& [key, rows] : groups_) {
      Row mean = rows.front();
      Row worst = rows.front();
      mean.scene = std::get<2>(key);
      mean.error = mean.time_us = 0;
      for (const Row& row : rows) {
        mean.error += row.error / double(rows.size());
        mean.time_us += row.time_us / double(rows.size());
        if (row.error > worst.error) worst = row;
      }
      report_.add(mean);
      if (mean.scene != "mean") continue;
      worst.scene = "worst";
      report_.add(worst);
    }
    groups_.clear();
  }

 private:
  Report& report_;
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<Row>> groups_;
};

void drawContactSheet(const Clip& clip, const MaskRun& run, const Options& options) {
  ContactSheet sheet(5);
  for (std::size_t i = 0; i < run.masks.size(); ++i)
    sheet.show(clip.frames[i].color, run.masks[i], clip.truth[i].mask);
  sheet.write(options.out / ("vision_" + clip.scene + "_" + clip.sensor + ".png"));
}

void measureMasks(const Clip& clip, const Options& options, Summary& summary) {
  for (const Variant& variant : kVariants) {
    const MaskRun run = runSegmenter(clip, variant.mode, variant.method);
    const MaskErrors errors = errorsOf(run, clip);
    if (variant.is_default) drawContactSheet(clip, run, options);
    const auto row = [&](const char* stage, double error, double time_us) {
      const bool flicker = stage == std::string("flicker");
      summary.add({clip.name(), stage, variant.name, error,
                   flicker ? "share of the area per frame" : "1 - IoU", time_us, variant.is_default,
                   variant.is_thesis},
                  clip.sensor);
    };
    row("mask", errors.mask, run.times.segmentation());
    row("mask, 95 % of frames", errors.worst, run.times.segmentation());
    row("start", errors.first, run.start_us);
    row("flicker", errors.flicker, run.times.segmentation());
    if (errors.lost > 0) std::fprintf(stderr, "             %zu frames without\n", errors.lost);
  }
}

// By the exact mask, depth beside colour would be an error of another stage.
std::vector<NamedSensor> alignedSensors() {
  std::vector<NamedSensor> out;
  for (NamedSensor sensor : sensors()) {
    if (std::string(sensor.name) == "rs4") continue;
    sensor.sensor.misalignment_px = 0;
    if (std::string(sensor.name) == "tof2") sensor.name = "tof0";
    out.push_back(sensor);
  }
  return out;
}

// Cost of segment and enhance, by size of the picture: in the table, not drawn.
void measureTimes(const Clip& clip, const char* size, Report& report) {
  const MaskRun run = runSegmenter(clip, server::SegmentMode::kBand, Method::kHapticast);
  const std::string scene = clip.name() + " " + size;
  const auto row = [&](const char* variant, double time_us) {
    report.add({scene, "run time", variant, time_us / 1e3, "ms", 0.0, false, false});
  };
  row("view", run.times.view);
  row("track", run.times.track);
  row("segment", run.times.segment);
  row("clean", run.times.clean);
  row("relief", run.times.relief);
  row("track + segment + enhance", run.times.segmentation() + run.times.enhancement());
}

bool oneOf(const std::string& name, std::initializer_list<const char*> names) {
  return std::any_of(names.begin(), names.end(), [&](const char* n) { return name == n; });
}

// Masks and reliefs of single bodies on exact paths.
void measureScenes(const Options& options, Report& report) {
  Summary summary(report);
  for (const TestScene& scene : segmentationScenes()) {
    if (options.quick && !oneOf(scene.name, {"ball_air", "ball_same", "occluder", "still"}))
      continue;
    for (const Clip& clip : renderClips(scene, sensors(), {640, 480, 40})) {
      if (!options.quick || oneOf(clip.sensor, {"rs0", "b8"})) measureMasks(clip, options, summary);
      if (oneOf(scene.name, {"ball_air", "still"}) && clip.sensor == "rs0")
        measureTimes(clip, "640x480", report);
    }
    if (!oneOf(scene.name, {"ball_air", "still"})) continue;
    for (const Clip& clip : renderClips(scene, alignedSensors(), {640, 480, 40}))
      measureReliefs(clip, report);
    for (const Clip& clip : renderClips(scene, {sensors().front()}, {1920, 1080, 10}))
      measureTimes(clip, "1080p", report);
  }
  summary.finish();
}

}  // namespace

static void evaluateVision(const Options& options) {
  Report report("vision", options);
  const auto only = [&](const char* part) { return options.only.rfind(part, 0) == 0; };
  const bool a_part =
      only("surface") || only("deform") || only("estimated") || only("drawn") || only("rules");
  if (!options.only.empty() && !only("held") && !a_part)
    throw std::runtime_error("vision: --only " + options.only +
                             " is none of held, held/NAME, surface, surface/NAME, deform, "
                             "deform/NAME, estimated, drawn, rules, rules/NAME");
  if (!only("held") && !a_part) {
    measureScenes(options, report);
    measureRealClips(options, report);
  }
  if (!a_part) measureHeld(options, report);
  const bool whole = !only("held") && !a_part && !options.quick;
  if (only("drawn") || options.only.empty()) measureKeyMasks(report);
  if (only("estimated") || options.only.empty()) measureEstimated(report);
  if (only("rules")) measureRules(options, report);
  if (only("surface") || whole) measureHeldSurfaces(options, report);
  if (only("deform") || whole) measureDeforming(options, report);
  report.write();
}

const RegisteredTopic kVisionTopic(
    "vision",
    {.about = "masks and reliefs, things in hands, real clips",
     .method = "Masks, reliefs and the noise of the force of a scene at rest, then things held in "
               "hands: masks from one click, from clicks anywhere and after corrections. The truth "
               "is the exact mask, surface and motion of each frame, in real clips the change from "
               "frame to frame. Scenes marked (apart) were drawn after the method.",
     .evaluate = evaluateVision});

}  // namespace hapticast::evaluate
