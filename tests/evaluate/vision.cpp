// SPDX-License-Identifier: MIT
// Masks of every segmenter, reliefs of every enhancement and what they cost, against exact truth;
// then the real clips.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "tests/evaluate/topics.hpp"
#include "tests/evaluate/vision_run.hpp"

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

void measureMasks(const Clip& clip, Summary& summary) {
  for (const Variant& variant : kVariants) {
    const MaskRun run = runSegmenter(clip, variant.mode, variant.method);
    const MaskErrors errors = errorsOf(run, clip);
    const auto row = [&](const char* stage, double error, double time_us) {
      summary.add({clip.name(), stage, variant.name, error, "1 - IoU", time_us, variant.is_default,
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

}  // namespace

void evaluateVision(const Options& options) {
  Report report("vision", options);
  Summary summary(report);
  const char* only = std::getenv("ONLY_SCENE");
  for (const TestScene& scene : segmentationScenes()) {
    if (only != nullptr && scene.name != only) continue;
    for (const Clip& clip : renderClips(scene, sensors(), {640, 480, options.quick ? 20U : 40U}))
      measureMasks(clip, summary);
  }
  summary.finish();
  report.write();
}

}  // namespace hapticast::evaluate
