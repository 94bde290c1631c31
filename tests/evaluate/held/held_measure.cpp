// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held_measure.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "server/vision/base/frame_pair.hpp"
#include "server/vision/base/masks.hpp"
#include "tests/evaluate/vision/vision_sheet.hpp"

namespace hapticast::evaluate::held {

namespace {

constexpr double kWorthAWord = 0.02;  // of the object's area: authors leave smaller faults
constexpr double kShown = 0.25;       // of the object is seen where its mask is drawn

const char* formatName(DepthSense sense) {
  switch (sense) {
    case DepthSense::kExact:
      return "exact";
    case DepthSense::kStructured:
      return "structured";
    case DepthSense::kFlight:
      return "flight";
    case DepthSense::kRoom8:
      return "room8";
    case DepthSense::kEstimate8:
      return "estimate8";
    case DepthSense::kEstimate16:
      return "estimate16";
  }
  return "";
}

cv::Mat depthPicture(const server::RgbdFrame& frame, const server::SourceInfo& info) {
  cv::Mat levels;
  if (info.depth_kind == server::DepthKind::kHeight) {
    frame.depth.convertTo(levels, CV_8U);
  } else {
    cv::Mat(255.0 - (frame.depth - 300.0) * (255.0 / 1000.0)).convertTo(levels, CV_8U);
    levels.setTo(0, frame.depth == 0);
  }
  cv::cvtColor(levels, levels, cv::COLOR_GRAY2BGR);
  return levels;
}

void drawContactSheet(const Recording& recording, const Run& run,
                      const std::filesystem::path& sheets) {
  ContactSheet sheet(1);
  const std::size_t every = std::max<std::size_t>(1, recording.frames.size() / 8);
  for (std::size_t i = 0; i < run.masks.size(); i += every) {
    const server::RgbdFrame& frame = recording.frames[i];
    const cv::Mat truth = recording.truth[i].mask();
    sheet.show(frame.color, run.masks[i], truth, i);
    sheet.show(depthPicture(frame, recording.info), run.masks[i], truth, i);
  }
  sheet.write(sheets / ("vision_held_" + recording.name + ".png"));
}

// Adds a point at the largest fault of the clip to `words`. Returns false if no fault is large
// enough.
bool correct(const Recording& recording, const Run& run, Words& words) {
  double most = kWorthAWord;
  std::optional<server::AuthorPoint> said;
  bool off = false;
  for (std::size_t i = 0; i < run.masks.size(); ++i) {
    const auto wrong = findLargestWrong(recording, run, i);
    if (!wrong || wrong->share <= most) continue;
    most = wrong->share;
    said = server::AuthorPoint{wrong->middle_px, recording.frames[i].clip_time_s};
    off = wrong->foreign;
  }
  if (!said) return false;
  (off ? words.off : words.on).push_back(*said);
  return true;
}

std::size_t worstFrame(const Recording& recording, const Run& run) {
  std::size_t out = 0;
  double worst = 2.0;
  for (std::size_t i = 0; i < run.masks.size(); ++i) {
    if (recording.truth[i].visibleShare() < kShown) continue;
    const double iou = run.masks[i].empty()
                           ? 0.0
                           : server::computeOverlap(run.masks[i], recording.truth[i].mask());
    if (iou >= worst) continue;
    worst = iou;
    out = i;
  }
  return out;
}

}  // namespace

Result measure(const Scene& scene, const std::filesystem::path& sheets, const Effort& effort) {
  const Recording recording = record(scene, {640, 480});
  Result out;
  out.name = scene.name;
  out.sensor = formatName(scene.sensing.kind);
  out.held_at_start = scene.held_at_start;
  out.reported_apart = scene.reported_apart;
  const Words click{{{*innermost(recording.truth[0].mask())}}, {}, {}};
  const Run run = runVision(recording, click);
  out.one_click = scoresOf(recording, run);
  out.refused = run.refused;
  if (!sheets.empty()) drawContactSheet(recording, run, sheets);
  out.starts = clickAround(recording, 0, effort.clicks);
  if (effort.trials) out.trials = tryOut(recording, run, click, 0.4 * effort.clicks);
  Words points = click;
  Words masks = click;
  Run by_points = run;
  Run by_masks = run;
  for (std::size_t n = 0; n < out.by_points.size(); ++n) {
    if (correct(recording, by_points, points)) by_points = runVision(recording, points);
    out.by_points[n] = scoresOf(recording, by_points);
    masks.drawn.push_back(worstFrame(recording, by_masks));
    by_masks = runVision(recording, masks);
    out.by_masks[n] = scoresOf(recording, by_masks);
  }
  return out;
}

Times timesOf(const Scene& scene, const cv::Size& size, std::size_t frames) {
  const Recording recording = record(scene, size, frames);
  const Words words{{{*innermost(recording.truth[0].mask())}}, {}, {}};
  const Run one = runVision(recording, words);
  const Run two = runVision(recording, words, 2);
  const Scores scores = scoresOf(recording, one);
  Times out{scores.median_ms, scores.slow_ms, one.frames_s, two.frames_s, 0};
  for (std::size_t i = 0; i < one.masks.size(); ++i) {
    const bool same =
        server::equalImages(one.masks[i], two.masks[i]) &&
        one.objects[i].size() == two.objects[i].size() &&
        std::equal(one.objects[i].begin(), one.objects[i].end(), two.objects[i].begin(),
                   [](const auto& a, const auto& b) {
                     return a.relief->height_mm == b.relief->height_mm && a.motion == b.motion;
                   });
    if (!same) ++out.different_frames;
  }
  return out;
}

}  // namespace hapticast::evaluate::held
