// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/held/held_run.hpp"
#include "tests/evaluate/vision/vision_sheet.hpp"

namespace hapticast::evaluate {

namespace {

using held::Clicks;
using held::Recording;
using held::Scores;

constexpr double kGoodStart = 0.8;  // IoU
constexpr double kBadStart = 0.5;
constexpr double kFromEdge_px = 3.0;  // nobody clicks on the very edge

struct Starts {
  std::size_t clicks = 0, good = 0, bad = 0, refused = 0;

  void add(const Starts& other) {
    clicks += other.clicks;
    good += other.good;
    bad += other.bad;
    refused += other.refused;
  }
  [[nodiscard]] double share(std::size_t of) const {
    return double(of) / std::max(1.0, double(clicks));
  }
};

// All that is measured of one scene.
struct Result {
  std::string name, sensor;
  bool held_at_start = false;
  Scores one_click;
  std::string refused;
  Starts starts;
  bool corrected = false;  // there was something to correct
  Scores one_not, two_nots;
};

const char* nameOf(held::DepthSense sense) {
  switch (sense) {
    case held::DepthSense::kExact:
      return "exact";
    case held::DepthSense::kStructured:
      return "structured";
    case held::DepthSense::kFlight:
      return "flight";
    case held::DepthSense::kRoom8:
      return "room8";
    case held::DepthSense::kEstimate8:
      return "estimate8";
    case held::DepthSense::kEstimate16:
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

void drawSheet(const Recording& recording, const held::Run& run, const Options& options) {
  ContactSheet sheet(1);
  const std::size_t every = std::max<std::size_t>(1, recording.frames.size() / 8);
  for (std::size_t i = 0; i < run.masks.size(); i += every) {
    const server::RgbdFrame& frame = recording.frames[i];
    const cv::Mat truth = recording.truth[i].mask();
    sheet.show(frame.color, run.masks[i], truth);
    sheet.show(depthPicture(frame, recording.info), run.masks[i], truth);
  }
  sheet.write(options.out / ("vision_held_" + recording.name + ".png"));
}

Starts clickAround(const Recording& recording, double clicks) {
  const cv::Mat truth = recording.truth[0].mask();
  cv::Mat distance;
  cv::distanceTransform(truth, distance, cv::DIST_L2, 5);
  const int step = std::max(2, static_cast<int>(std::sqrt(cv::countNonZero(truth) / clicks)));
  Starts out;
  for (int v = step / 2; v < truth.rows; v += step) {
    for (int u = step / 2; u < truth.cols; u += step) {
      if (double(distance.at<float>(v, u)) < kFromEdge_px) continue;
      ++out.clicks;
      const auto mask = held::startOf(recording, {{{u + 0.5, v + 0.5}}, {}});
      if (!mask) ++out.refused;
      const double iou = mask ? held::overlapOf(*mask, truth) : 0.0;
      if (iou > kGoodStart) ++out.good;
      if (iou < kBadStart) ++out.bad;
    }
  }
  return out;
}

// Where the author says "not this": in what is wrong in the first frame, else in the hand.
std::optional<Vec2> correctionAfter(const Recording& recording, const Clicks& clicks) {
  const held::Truth& truth = recording.truth[0];
  const cv::Mat hand = (truth.id == static_cast<int>(held::kHand)) |
                       (truth.id == static_cast<int>(held::kOtherHand));
  const auto mask = held::startOf(recording, clicks);
  if (mask) {
    cv::Mat wrong = *mask & (truth.id != static_cast<int>(held::kObject));
    cv::Mat distance;
    cv::distanceTransform(truth.mask() == 0, distance, cv::DIST_L2, 5);
    wrong &= distance > 4.0;
    cv::erode(wrong, wrong, cv::Mat::ones(3, 3, CV_8UC1));
    if (const auto at = held::innermost(wrong & hand)) return at;
    if (const auto at = held::innermost(wrong)) return at;
  }
  cv::Mat fresh = hand.clone();
  for (const Vec2& not_px : clicks.off)
    cv::circle(fresh, cv::Point(cvRound(not_px.x()), cvRound(not_px.y())), 40, cv::Scalar(0), -1);
  return held::innermost(fresh);
}

Result measure(const held::Scene& scene, const Options& options) {
  const Recording recording = held::record(scene, {640, 480});
  Result out;
  out.name = scene.name;
  out.sensor = nameOf(scene.sensing.kind);
  out.held_at_start = scene.held_at_start;
  Clicks clicks{{*held::innermost(recording.truth[0].mask())}, {}};
  const held::Run run = held::watch(recording, clicks);
  out.one_click = held::scoresOf(recording, run);
  out.refused = run.refused;
  drawSheet(recording, run, options);
  out.starts = clickAround(recording, options.quick ? 10.0 : 40.0);
  if (!scene.held_at_start) return out;
  for (Scores* scores : {&out.one_not, &out.two_nots}) {
    const auto correction = correctionAfter(recording, clicks);
    if (correction) clicks.off.push_back(*correction);
    *scores = held::scoresOf(recording, held::watch(recording, clicks));
  }
  out.corrected = true;
  return out;
}

std::string shown(double share) { return text("%.3f", share); }

void tellScenes(const std::vector<Result>& results, Report& report) {
  std::vector<std::vector<std::string>> lines{{"scene", "depth", "IoU mean", "worst", "foreign",
                                               "worst", "lost", "relief share", "velocity error",
                                               "ms/frame", "95 %"}};
  for (const Result& r : results) {
    const Scores& s = r.one_click;
    lines.push_back({r.name + (r.held_at_start ? " (held)" : ""), r.sensor, shown(s.mean_iou),
                     shown(s.worst_iou), shown(s.foreign), shown(s.worst_foreign),
                     text("%zu of %zu", s.lost, s.frames), shown(s.relief_share),
                     s.velocity_error < 0 ? "rests" : shown(s.velocity_error),
                     text("%.1f", s.median_ms), text("%.1f", s.slow_ms)});
    const auto row = [&](const char* stage, double error, const char* unit) {
      report.add({r.name + "/" + r.sensor, stage, "band", error, unit, 0.0, true, false});
    };
    row("held: mask", 1.0 - s.mean_iou, "1 - IoU");
    row("held: worst mask", 1.0 - s.worst_iou, "1 - IoU");
    row("held: foreign", s.foreign, "share of the area");
    row("held: lost", double(s.lost), "frames");
    row("held: relief unused", 1.0 - s.relief_share, "share of 30 mm");
    if (s.velocity_error >= 0) row("held: velocity", s.velocity_error, "of the rms");
    row("held: run time", s.median_ms, "ms");
    row("held: run time, 95 %", s.slow_ms, "ms");
  }
  report.say(
      "Held things, one click on the innermost point of the first frame. Foreign: pixels of the "
      "mask more "
      "than 2 px outside the object, share of its area. Lost: frames with IoU < .1 of those in "
      "which a quarter "
      "of the object is seen. Velocity: in the picture, rms over the rms of the true one.\n\n" +
      markdown(lines));
  for (const Result& r : results) {
    if (!r.refused.empty()) report.say("Refused, " + r.name + ": " + r.refused);
  }
}

void tellStarts(const std::vector<Result>& results, Report& report) {
  std::vector<std::vector<std::string>> lines{
      {"first frame", "clicks", "IoU > .8", "IoU < .5", "refused"}};
  Starts sums[2];
  const auto line = [&](const std::string& name, const Starts& s) {
    lines.push_back({name, std::to_string(s.clicks), text("%.2f", s.share(s.good)),
                     text("%.2f", s.share(s.bad)), text("%.2f", s.share(s.refused))});
  };
  for (const Result& r : results) {
    line(r.name + (r.held_at_start ? " (held)" : " (bare)"), r.starts);
    sums[r.held_at_start ? 1 : 0].add(r.starts);
    report.add({r.name + "/" + r.sensor, "held: starts", "band",
                1.0 - r.starts.share(r.starts.good), "share of clicks not > .8", 0.0, true, false});
  }
  line("all bare", sums[0]);
  line("all held", sums[1]);
  report.say("Clicks anywhere inside the object, 3 px from its edge and more:\n\n" +
             markdown(lines));
  const char* names[] = {"clicks on bare objects that start badly",
                         "clicks on held objects that start badly"};
  const double required[] = {0.05, 0.15};
  const double aims[] = {0.01, 0.05};
  for (std::size_t i = 0; i < 2; ++i) {
    if (sums[i].clicks > 0)
      report.add(Goal{names[i], "share", required[i], aims[i], 1.0 - sums[i].share(sums[i].good)});
  }
}

void tellCorrections(const std::vector<Result>& results, Report& report) {
  std::vector<std::vector<std::string>> lines{{"scene", "one click", "worst", "foreign",
                                               "and one not", "worst", "foreign", "and two",
                                               "worst", "foreign"}};
  double mean = 0.0;
  double worst = 1.0;
  double count = 0.0;
  for (const Result& r : results) {
    if (!r.corrected) continue;
    std::vector<std::string> line{r.name};
    for (const Scores* s : {&r.one_click, &r.one_not, &r.two_nots}) {
      line.push_back(shown(s->mean_iou));
      line.push_back(shown(s->worst_iou));
      line.push_back(shown(s->foreign));
    }
    lines.push_back(line);
    report.add(
        {r.name + "/" + r.sensor, "held: mask", "one not", 1.0 - r.one_not.mean_iou, "1 - IoU"});
    report.add(
        {r.name + "/" + r.sensor, "held: mask", "two nots", 1.0 - r.two_nots.mean_iou, "1 - IoU"});
    mean += r.two_nots.mean_iou;
    worst = std::min(worst, r.two_nots.worst_iou);
    count += 1.0;
  }
  if (count == 0.0) return;
  report.say(
      "Corrections: what a person would click on as not meant in the first frame (the innermost "
      "point of what is "
      "wrong in the hand, else anywhere, else of the hand):\n\n" +
      markdown(lines));
  report.add(Goal{"held, two corrections: 1 - IoU, mean", "", 0.05, 0.02, 1.0 - mean / count});
  report.add(Goal{"held, two corrections: 1 - IoU, worst", "", 0.10, 0.06, 1.0 - worst});
}

void setGoals(const std::vector<Result>& results, Report& report) {
  Scores all;
  double least_relief = 1.0;
  double velocity = 0.0;
  double foreign = 0.0;
  std::size_t lost = 0;
  for (const Result& r : results) {
    all.mean_iou += r.one_click.mean_iou / double(results.size());
    all.worst_iou = std::min(all.worst_iou, r.one_click.worst_iou);
    foreign += r.one_click.foreign / double(results.size());
    least_relief = std::min(least_relief, r.one_click.relief_share);
    velocity = std::max(velocity, r.one_click.velocity_error);
    lost += r.one_click.lost;
  }
  report.add(Goal{"held, one click: 1 - IoU, mean", "", 0.10, 0.05, 1.0 - all.mean_iou});
  report.add(Goal{"held, one click: 1 - IoU, worst", "", 0.25, 0.12, 1.0 - all.worst_iou});
  report.add(Goal{"held: foreign pixels", "share of the area", 0.05, 0.01, foreign});
  report.add(Goal{"held: frames lost", "", 0.0, 0.0, double(lost)});
  report.add(
      Goal{"held: announced depth unused, worst scene", "share", 0.40, 0.15, 1.0 - least_relief});
  report.add(Goal{"held: velocity, worst scene", "share", 0.10, 0.03, velocity});
}

bool begins(const std::string& name, const std::string& with) { return name.rfind(with, 0) == 0; }

}  // namespace

void measureHeld(const Options& options, Report& report) {
  const std::string only = begins(options.only, "held/") ? options.only.substr(5) : "";
  std::vector<held::Scene> scenes;
  for (held::Scene& scene : held::heldScenes(options.set)) {
    const bool brief =
        begins(scene.name, "mug_") || begins(scene.name, "bear_") || scene.name == "ball_hidden";
    if (!begins(scene.name, only) || (options.quick && only.empty() && !brief)) continue;
    scenes.push_back(std::move(scene));
  }
  std::vector<Result> results(scenes.size());
  onAllCores(scenes.size(), [&](std::size_t i) { results[i] = measure(scenes[i], options); });
  if (results.empty()) return;
  tellScenes(results, report);
  tellStarts(results, report);
  tellCorrections(results, report);
  setGoals(results, report);
}

}  // namespace hapticast::evaluate
