// SPDX-License-Identifier: MIT
// Real captures against masks that were drawn by hand (tests/data/key_masks): one click in the
// first frame, and the first mask alone at each drawn frame. Half of the drawn frames may fit
// parameters; the other half is for checks only.
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>

#include "server/source/rgbd_source.hpp"
#include "server/vision/base/masks.hpp"
#include "server/vision/segment/segmenter.hpp"
#include "server/vision/tracker.hpp"
#include "tests/evaluate/held/held_run.hpp"
#include "tests/evaluate/vision/vision_parts.hpp"
#include "tests/support/clips.hpp"

namespace hapticast::evaluate {

namespace {

/// An object with the pixel that means it in frame 0.
struct DrawnObject {
  const char* clip;
  const char* name;
  int value;  // in the drawn masks
  Vec2 click_px;
};
const DrawnObject kDrawn[] = {{"visp_rbt_desk", "dragon", 1, {474, 347}},
                              {"visp_rbt_desk", "cube", 2, {257, 305}},
                              {"dkvfx_typing_person", "right hand", 1, {235, 292}},
                              {"dkvfx_typing_person", "left hand", 2, {266, 265}},
                              {"tum_fr1_rpy", "monitor", 1, {204, 128}}};

/// Drawn masks by frame, 0/255.
std::map<std::uint64_t, cv::Mat> readMasks(const DrawnObject& object) {
  std::map<std::uint64_t, cv::Mat> masks;
  const std::filesystem::path folder = std::filesystem::path(HAPTICAST_KEY_MASKS) / object.clip;
  for (const auto& file : std::filesystem::directory_iterator(folder))
    masks[std::stoull(file.path().stem().string())] =
        cv::imread(file.path().string(), cv::IMREAD_GRAYSCALE) == object.value;
  return masks;
}

cv::Mat maskOf(const server::RgbdFrame& frame, server::Tracker& tracker, double time_s) {
  return held::collectMask(tracker.next(frame, time_s), frame.color.size());
}

/// Sums of the overlap over the frames for fits and over those for checks.
struct Overlap {
  double sum[2] = {0.0, 0.0};
  int count[2] = {0, 0};

  void add(bool checks, double iou) {
    sum[checks ? 1 : 0] += iou;
    ++count[checks ? 1 : 0];
  }
  [[nodiscard]] double mean(bool checks) const {
    return sum[checks ? 1 : 0] / std::max(1, count[checks ? 1 : 0]);
  }
};

/// A tracker of one click.
class ClickTracker {
 public:
  ClickTracker(const server::SourceInfo& info, const Vec2& click_px)
      : settings_(makeSettings(click_px)), tracker_(info, settings_, nullptr, next_id_, kept_) {}
  [[nodiscard]] server::Tracker& tracker() { return tracker_; }

 private:
  static server::VisionSettings makeSettings(const Vec2& click_px) {
    server::VisionSettings settings;
    settings.segment = server::SegmentMode::kBand;
    settings.object_points = {{click_px}};
    return settings;
  }
  server::VisionSettings settings_;
  std::uint32_t next_id_ = 1;
  server::ClipAnnotations kept_;
  server::Tracker tracker_;
};

double startAt(const server::RgbdFrame& frame, const server::SourceInfo& info,
               const cv::Mat& truth) {
  const cv::Point deepest = server::findDeepestPoint(truth);
  try {
    ClickTracker start(info, {deepest.x + 0.5, deepest.y + 0.5});
    return server::computeOverlap(maskOf(frame, start.tracker(), 0.0), truth);
  } catch (const server::SourceError&) {
    return 0.0;  // refused
  }
}

void measureObject(const DrawnObject& object, Report& report) {
  const auto source = server::openSource((test::clipsFolder() / object.clip).string(), 0.0);
  const std::map<std::uint64_t, cv::Mat> masks = readMasks(object);
  ClickTracker carried(source->info(), object.click_px);
  Overlap carry;
  Overlap start;
  bool checks = true;
  while (const auto frame = source->read()) {
    if (frame->index > masks.rbegin()->first) break;
    const cv::Mat mask = maskOf(*frame, carried.tracker(), frame->clip_time_s);
    const auto truth = masks.find(frame->index);
    if (truth == masks.end()) continue;
    checks = !checks;  // the first drawn frame is for fits
    carry.add(checks, server::computeOverlap(mask, truth->second));
    start.add(checks, startAt(*frame, source->info(), truth->second));
  }
  const auto row = [&](const char* stage, const char* variant, double iou) {
    report.add({object.name, stage, variant, 1.0 - iou, "1 - IoU", 0.0, true, false});
  };
  row("drawn masks: one click", "frames for checks", carry.mean(true));
  row("drawn masks: one click", "frames for fits", carry.mean(false));
  row("drawn masks: start at each", "frames for checks", start.mean(true));
  row("drawn masks: start at each", "frames for fits", start.mean(false));
}

}  // namespace

void measureKeyMasks(Report& report) {
  for (const DrawnObject& object : kDrawn) {
    if (std::filesystem::exists(test::clipsFolder() / object.clip)) {
      measureObject(object, report);
    } else {
      report.leaveOut(object.name);
    }
  }
}

}  // namespace hapticast::evaluate
