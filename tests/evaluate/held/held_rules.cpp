// SPDX-License-Identifier: MIT
// Ablation of the segmentation: tracks every held scene from one click, once as it is and once
// without each term or rule (server/vision/segment/rules.hpp). A row is the IoU that the mean of
// the scenes loses without the rule. It also compares the chosen first mask with the best candidate
// that the program computed. Thread: all cores.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/segment/follow/select_initial_mask.hpp"
#include "server/vision/segment/rules.hpp"
#include "server/vision/tracker.hpp"
#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/held/held.hpp"
#include "tests/evaluate/held/held_run.hpp"

namespace hapticast::evaluate {

namespace {

using held::Recording;

constexpr double kLeastVisible = 0.25;   // of the object: as in the scores of the held scenes
constexpr double kWorthKeeping = 0.003;  // required, IoU: a rule below it goes

struct Tracked {
  double start_iou = 0.0;
  double mean_iou = 0.0;
};

server::VisionSettings makeSettings(const Recording& recording) {
  server::VisionSettings settings;
  settings.segment = server::SegmentMode::kBand;
  settings.object_points = {{*held::innermost(recording.truth[0].mask())}};
  return settings;
}

Tracked trackRecording(const Recording& recording) {
  Tracked out;
  std::uint32_t ids = 1;
  server::ClipAnnotations annotations;
  const server::VisionSettings settings = makeSettings(recording);
  server::Tracker tracker(recording.info, settings, nullptr, ids, annotations);
  double count = 0.0;
  try {
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
      const server::RgbdFrame& frame = recording.frames[i];
      const cv::Mat mask = held::collectMask(tracker.next(frame, double(i) / recording.info.fps),
                                             frame.color.size());
      if (recording.truth[i].visibleShare() < kLeastVisible) continue;
      const double iou = server::computeOverlap(mask, recording.truth[i].mask());
      if (i == 0) out.start_iou = iou;
      out.mean_iou += iou;
      count += 1.0;
    }
  } catch (const server::SourceError&) {  // refused: the scene counts as 0
    return {};
  }
  out.mean_iou /= std::max(1.0, count);
  return out;
}

std::vector<Tracked> trackAll(const std::vector<Recording>& recordings) {
  std::vector<Tracked> out(recordings.size());
  onAllCores(recordings.size(), [&](std::size_t i) { out[i] = trackRecording(recordings[i]); });
  return out;
}

struct Choice {
  double chosen_iou = 0.0;
  double best_iou = 0.0;  // of the candidates that the program computed itself
};

// The first mask at one frame, from a click on the innermost pixel of the true mask.
Choice computeChoice(const Recording& recording, std::size_t frame) {
  const cv::Mat truth = recording.truth[frame].mask();
  const std::optional<Vec2> at_px = held::innermost(truth);
  if (!at_px) return {};
  server::FramePairs pairs(recording.info, false);
  const server::FramePair pair = pairs.push(recording.frames[frame], 0.0);
  server::SceneContext scene;
  scene.noise = pair.noise;
  scene.planes = server::findPlanes(pair.now.depth, pair.noise);
  scene.skin = server::SkinColors::adaptToLight(pair.now.color);
  const cv::Point at(static_cast<int>(at_px->x()), static_cast<int>(at_px->y()));
  const auto ranked = server::selectInitialMask(pair.now, scene, at, {}).ranked;
  if (ranked.empty()) return {};
  Choice out{server::computeOverlap(ranked.front().mask(), truth), 0.0};
  for (const server::TrackedMask& each : ranked)
    out.best_iou = std::max(out.best_iou, server::computeOverlap(each.mask(), truth));
  return out;
}

// Compares the chosen mask with the best candidate, at three frames of each scene.
void measureChoices(const std::vector<Recording>& recordings, Report& report) {
  constexpr std::size_t kFrames = 3;
  std::vector<Choice> all(kFrames * recordings.size());
  onAllCores(all.size(), [&](std::size_t i) {
    const Recording& recording = recordings[i / kFrames];
    all[i] = computeChoice(recording, (i % kFrames) * recording.frames.size() / kFrames);
  });
  double chosen = 0.0;
  double best = 0.0;
  for (const Choice& each : all) {
    chosen += each.chosen_iou / double(all.size());
    best += each.best_iou / double(all.size());
  }
  report.add({"held scenes", "rules: first mask", "chosen", 1.0 - chosen, "1 - IoU"});
  report.add({"held scenes", "rules: first mask", "best candidate", 1.0 - best, "1 - IoU"});
  report.add(Goal{"held: best of its own candidates less the chosen one", "IoU", 0.03, 0.0,
                  best - chosen});
}

Tracked computeMean(const std::vector<Tracked>& all) {
  Tracked sum;
  for (const Tracked& each : all) {
    sum.start_iou += each.start_iou / double(all.size());
    sum.mean_iou += each.mean_iou / double(all.size());
  }
  return sum;
}

// The scenes that are reported apart were drawn after the method.
void reportAsItIs(const std::vector<held::Scene>& scenes, const std::vector<Tracked>& tracked,
                  Report& report) {
  std::array<std::vector<Tracked>, 2> groups;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const double iou = tracked[i].mean_iou;
    report.add({scenes[i].name, "rules: as it is", "start", 1.0 - tracked[i].start_iou, "1 - IoU"});
    report.add({scenes[i].name, "rules: as it is", "clip", 1.0 - iou, "1 - IoU"});
    groups[scenes[i].reported_apart ? 1 : 0].push_back(tracked[i]);
  }
  for (const bool apart : {false, true}) {
    const Tracked mean = computeMean(groups[apart ? 1 : 0]);
    const char* where = apart ? "mean (apart)" : "mean";
    report.add({where, "rules: as it is", "start", 1.0 - mean.start_iou, "1 - IoU"});
    report.add({where, "rules: as it is", "clip", 1.0 - mean.mean_iou, "1 - IoU"});
  }
}

}  // namespace

void measureRules(const Options& options, Report& report) {
  const std::string only = options.only.size() > 6 ? options.only.substr(6) : "";
  const bool known = std::any_of(server::kRuleNames.begin(), server::kRuleNames.end(),
                                 [&](const char* name) { return std::strstr(name, only.c_str()); });
  if (!known) throw std::runtime_error("--only " + options.only + ": no rule's name contains this");
  const std::vector<held::Scene> scenes = held::heldScenes(options.set);
  std::vector<Recording> recordings(scenes.size());
  onAllCores(scenes.size(), [&](std::size_t i) {
    recordings[i] = held::record(scenes[i], {640, 480});
  });
  const std::vector<Tracked> as_it_is = trackAll(recordings);
  reportAsItIs(scenes, as_it_is, report);
  measureChoices(recordings, report);
  const Tracked all = computeMean(as_it_is);
  for (std::size_t rule = 0; rule < server::kRuleNames.size(); ++rule) {
    const char* name = server::kRuleNames[rule];
    if (!only.empty() && std::strstr(name, only.c_str()) == nullptr) continue;
    const auto before = server::rules_left_out;
    server::rules_left_out.set(rule);
    const Tracked without = computeMean(trackAll(recordings));
    server::rules_left_out = before;
    const double start = all.start_iou - without.start_iou;
    const double clip = all.mean_iou - without.mean_iou;
    report.add({"held scenes", "rules: start without", name, start, "IoU"});
    report.add({"held scenes", "rules: clip without", name, clip, "IoU"});
    if (std::max(start, clip) < kWorthKeeping)
      std::printf("  %s: worth less than %.3f\n", name, kWorthKeeping);
  }
}

}  // namespace hapticast::evaluate
