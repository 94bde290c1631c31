// SPDX-License-Identifier: MIT
#include "tests/evaluate/held/held.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <stdexcept>
#include <string_view>

#include "tests/evaluate/all_cores.hpp"
#include "tests/evaluate/held/held_trials_report.hpp"

namespace hapticast::evaluate {

namespace {

using held::Result;
using held::Scores;
using held::Starts;

std::string shown(double share) { return text("%.3f", share); }

void reportScenes(const std::vector<Result>& results, Report& report) {
  Table lines{{"scene", "depth", "IoU mean", "IoU worst", "foreign", "foreign worst", "lost",
               "relief share", "velocity error", "grid", "force noise", "ms/frame", "95 %"}};
  for (const Result& r : results) {
    const Scores& s = r.one_click;
    lines.push_back({r.name + (r.held_at_start ? " (held)" : ""), r.sensor, shown(s.mean_iou),
                     shown(s.worst_iou), shown(s.foreign), shown(s.worst_foreign),
                     text("%zu of %zu", s.lost, s.frames), shown(s.relief_share),
                     s.velocity_error < 0 ? "rests" : shown(s.velocity_error),
                     s.grid_share < 0 ? "" : shown(s.grid_share),
                     s.noise_N < 0 ? "" : text("%.4f", s.noise_N), text("%.1f", s.median_ms),
                     text("%.1f", s.slow_ms)});
    const auto row = [&](const char* stage, double error, const char* unit) {
      report.add({r.name + "/" + r.sensor, stage, "band", error, unit, 0.0, true, false});
    };
    row("held: mask", 1.0 - s.mean_iou, "1 - IoU");
    row("held: worst mask", 1.0 - s.worst_iou, "1 - IoU");
    row("held: foreign", s.foreign, "share of the area");
    row("held: lost", double(s.lost), "frames");
    row("held: relief unused", 1.0 - s.relief_share, "share of 30 mm");
    if (s.velocity_error >= 0) row("held: velocity", s.velocity_error, "of the rms");
    if (s.grid_share >= 0) row("held: bending untold", 1.0 - s.grid_share, "of the mean square");
    if (s.noise_N >= 0) row("held: rest", s.noise_N, "N rms");
    row("held: run time", s.median_ms, "ms");
    row("held: run time, 95 %", s.slow_ms, "ms");
  }
  report.addTable("held", lines);
  for (const Result& r : results) {
    if (!r.refused.empty())
      std::fprintf(stderr, "note: %s is refused: %s\n", r.name.c_str(), r.refused.c_str());
  }
}

void reportStarts(const std::vector<Result>& results, const std::string& apart, Report& report) {
  Table lines{{"first frame", "clicks", "IoU > .8", "IoU < .5", "refused"}};
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
  line("all bare" + apart, sums[0]);
  line("all held" + apart, sums[1]);
  report.addTable("clicks", lines);
  const char* names[] = {"clicks on bare objects that start badly",
                         "clicks on held objects that start badly"};
  const double required[] = {0.05, 0.15};
  const double aims[] = {0.01, 0.05};
  for (std::size_t i = 0; i < 2; ++i) {
    if (sums[i].clicks > 0)
      report.add(
          Goal{names[i] + apart, "share", required[i], aims[i], 1.0 - sums[i].share(sums[i].good)});
  }
}

void reportCorrections(const std::vector<Result>& results, const std::string& apart,
                       Report& report) {
  Table lines{{"scene", "one click", "one click worst", "one point", "one point worst",
               "two points", "two points worst", "one mask", "one mask worst", "two masks",
               "two masks worst"}};
  Scores points;
  Scores masks;
  const auto sum = [&](Scores& all, const Scores& one) {
    all.mean_iou += one.mean_iou / double(results.size());
    all.worst_iou = std::min(all.worst_iou, one.worst_iou);
  };
  for (const Result& r : results) {
    std::vector<std::string> line{r.name};
    for (const Scores* s :
         {&r.one_click, &r.by_points[0], &r.by_points[1], &r.by_masks[0], &r.by_masks[1]}) {
      line.push_back(shown(s->mean_iou));
      line.push_back(shown(s->worst_iou));
    }
    lines.push_back(line);
    const std::string where = r.name + "/" + r.sensor;
    report.add({where, "held: mask", "two points", 1.0 - r.by_points[1].mean_iou, "1 - IoU"});
    report.add({where, "held: mask", "two masks", 1.0 - r.by_masks[1].mean_iou, "1 - IoU"});
    sum(points, r.by_points[1]);
    sum(masks, r.by_masks[1]);
  }
  report.addTable("corrections", lines);
  report.add(
      Goal{"held, two points: 1 - IoU, mean" + apart, "", 0.05, 0.02, 1.0 - points.mean_iou});
  report.add(
      Goal{"held, two points: 1 - IoU, worst" + apart, "", 0.10, 0.06, 1.0 - points.worst_iou});
  report.add(Goal{"held, two masks: 1 - IoU, mean" + apart, "", 0.05, 0.02, 1.0 - masks.mean_iou});
  report.add(
      Goal{"held, two masks: 1 - IoU, worst" + apart, "", 0.10, 0.06, 1.0 - masks.worst_iou});
}

// Sizes of cameras as they are sold.
void reportTimes(const std::vector<held::Scene>& scenes, Report& report) {
  constexpr std::size_t kFrames = 24;
  std::size_t different_frames = 0;
  constexpr std::string_view kLarge[] = {"mug_turned", "ball_handed_over", "bear_carried",
                                         "toy_muzzle", "tenth_beside_still"};
  for (const held::Scene& scene : scenes) {
    if (std::find(std::begin(kLarge), std::end(kLarge), scene.name) == std::end(kLarge)) continue;
    for (const cv::Size& size : {cv::Size(1280, 720), cv::Size(1920, 1080)}) {
      const held::Times times = held::timesOf(scene, size, kFrames);
      const std::string variant = text("%dp", size.height);
      report.add({scene.name, "held: run time", variant, times.median_ms, "ms"});
      report.add({scene.name, "held: run time, 95 %", variant, times.slow_ms, "ms"});
      report.add(
          {scene.name, "held: throughput", variant + ", 1 thread", times.one_frames_s, "1/s"});
      report.add(
          {scene.name, "held: throughput", variant + ", 2 threads", times.two_frames_s, "1/s"});
      different_frames += times.different_frames;
    }
  }
  report.add(Goal{"held: frames that differ between one thread and two", "frames", 0.0, 0.0,
                  double(different_frames)});
}

void setGoals(const std::vector<Result>& results, const std::string& apart, Report& report) {
  Scores all;
  double least_relief = 1.0;
  double velocity = 0.0;
  double noise = 0.0;
  double unexplained = 0.0;
  double foreign = 0.0;
  std::size_t lost = 0;
  for (const Result& r : results) {
    all.mean_iou += r.one_click.mean_iou / double(results.size());
    all.worst_iou = std::min(all.worst_iou, r.one_click.worst_iou);
    foreign += r.one_click.foreign / double(results.size());
    least_relief = std::min(least_relief, r.one_click.relief_share);
    // A bending object has many velocities: the grid's row has them.
    if (r.one_click.grid_share < 0) velocity = std::max(velocity, r.one_click.velocity_error);
    noise = std::max(noise, r.one_click.noise_N);
    if (r.one_click.grid_share >= 0)
      unexplained = std::max(unexplained, 1.0 - r.one_click.grid_share);
    lost += r.one_click.lost;
  }
  report.add(Goal{"held, one click: 1 - IoU, mean" + apart, "", 0.10, 0.05, 1.0 - all.mean_iou});
  report.add(Goal{"held, one click: 1 - IoU, worst" + apart, "", 0.25, 0.12, 1.0 - all.worst_iou});
  report.add(Goal{"held: foreign pixels" + apart, "share of the area", 0.05, 0.01, foreign});
  report.add(Goal{"held: frames lost" + apart, "", 0.0, 0.0, double(lost)});
  report.add(Goal{"held: announced depth unused, worst scene" + apart, "share", 0.40, 0.15,
                  1.0 - least_relief});
  report.add(
      Goal{"held: force noise at rest, estimated depth included" + apart, "N", 0.01, 0.0, noise});
  report.add(Goal{"held: bending untold by the grid" + apart, "share", 0.50, 0.20, unexplained});
  report.add(Goal{"held: velocity, worst rigid scene" + apart, "share", 0.10, 0.03, velocity});
}

// The scenes that are reported apart have tables and goals of their own.
void reportGroup(const std::vector<Result>& all, bool apart, Report& report) {
  std::vector<Result> group;
  std::copy_if(all.begin(), all.end(), std::back_inserter(group),
               [&](const Result& r) { return r.reported_apart == apart; });
  if (group.empty()) return;
  const std::string ending = apart ? " (apart)" : "";
  reportStarts(group, ending, report);
  reportCorrections(group, ending, report);
  reportTrials(group, ending, report);
  reportGains(group, ending, report);
  setGoals(group, ending, report);
}

bool begins(const std::string& name, const std::string& with) { return name.rfind(with, 0) == 0; }

}  // namespace

void measureHeld(const Options& options, Report& report) {
  const std::string only = begins(options.only, "held/") ? options.only.substr(5) : "";
  std::vector<held::Scene> scenes;
  for (held::Scene& scene : held::heldScenes(options.set)) {
    const bool brief = scene.name == "mug_turned" || scene.name == "bear_carried" ||
                       scene.name == "bottle_lifted" || scene.name == "ball_hidden";
    if (!begins(scene.name, only) || (options.quick && only.empty() && !brief)) continue;
    scenes.push_back(std::move(scene));
  }
  if (scenes.empty())
    throw std::runtime_error("--only " + options.only + ": no held scene's name begins so");
  std::vector<Result> results(scenes.size());
  const held::Effort effort{options.quick ? 10.0 : 20.0, !options.quick};
  onAllCores(scenes.size(),
             [&](std::size_t i) { results[i] = held::measure(scenes[i], options.out, effort); });
  reportScenes(results, report);
  for (const bool apart : {false, true}) reportGroup(results, apart, report);
  if (!options.quick) reportTimes(scenes, report);
}

}  // namespace hapticast::evaluate
