// SPDX-License-Identifier: MIT
#include "server/vision/scene_plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace hapticast::server {

namespace {

constexpr double kNew = 0.2;        // chosen: weight of a new measurement in the mean duration
constexpr double kFinger_mm = 1.0;  // chosen: penetration of a light touch

std::size_t stageIndex(Stage stage) { return static_cast<std::size_t>(stage); }

}  // namespace

ScenePlan::ScenePlan(const PlanSettings& settings, bool source_mask)
    : settings_(settings), source_mask_(source_mask) {}

std::optional<std::string> ScenePlan::explainOff(Stage stage) const {
  const std::optional<double>& cost_N = cost_N_[stageIndex(stage)];
  switch (stage) {
    case Stage::kSegment:
      if (source_mask_) return "the source brings the mask";
      break;
    case Stage::kSmooth:
    case Stage::kClean:
      // Both together stay within the budget: each may use half of it.
      if (cost_N && *cost_N <= 0.5 * settings_.error_budget_N) {
        return stage == Stage::kClean ? "the depth has no holes and nothing of the background"
                                      : "the depth is clean";
      }
      break;
    case Stage::kHeights:
      if (unchanged_ && !at_rest_) return "the heights did not change";
      break;
    case Stage::kGrid:
      if (cost_N && *cost_N <= settings_.error_budget_N && frame_ % kGridEvery >= kGridFrames)
        return "a rigid motion explains it";
      break;
    case Stage::kMotion:
      break;
  }
  if (at_rest_) return "the object is at rest";
  return std::nullopt;
}

std::string ScenePlan::explainStage(Stage stage) const {
  switch (stage) {
    case Stage::kSegment:
      return "the source brings no mask, and the scene changes";
    case Stage::kClean:
      return "the depth has holes or background in it";
    case Stage::kSmooth: {
      const std::optional<double>& cost_N = cost_N_[stageIndex(stage)];
      if (!cost_N) return "not measured yet";
      char text[64];
      std::snprintf(text, sizeof text, "without it the force would be off by %.3f N", *cost_N);
      return text;
    }
    case Stage::kGrid: {
      const std::optional<double>& cost_N = cost_N_[stageIndex(stage)];
      return cost_N && *cost_N > settings_.error_budget_N ? "the object deforms"
                                                          : "it is measured now";
    }
    case Stage::kMotion:
    case Stage::kHeights:
      break;
  }
  return released_.empty() ? "the scene changes" : "released: " + std::string(released_);
}

bool ScenePlan::isOn(Stage stage) const {
  if (settings_.forced[stageIndex(stage)]) return *settings_.forced[stageIndex(stage)];
  return settings_.everything || !explainOff(stage);
}

void ScenePlan::setResting(bool at_rest, std::string_view why) {
  // The cause of a release stays until the object has rested again.
  if (at_rest_ && !at_rest) released_ = why;
  at_rest_ = at_rest;
}

void ScenePlan::add(const StageReport& report) {
  for (std::size_t i = 0; i < kStages; ++i) {
    this_frame_ms_[i] += 1e3 * toSeconds(report.times[i]);
    if (report.costs_N[i]) cost_N_[i] = report.costs_N[i];
  }
  unchanged_ = report.unchanged.value_or(unchanged_);
}

void ScenePlan::nextFrame() {
  ++frame_;
  for (std::size_t i = 0; i < kStages; ++i) {
    if (this_frame_ms_[i] == 0.0) continue;
    time_ms_[i] += (time_ms_[i] == 0.0 ? 1.0 : kNew) * (this_frame_ms_[i] - time_ms_[i]);
    this_frame_ms_[i] = 0.0;
  }
}

bool ScenePlan::measureNow() const { return frame_ % kMeasureEvery == 0; }

std::vector<PlanLine> ScenePlan::lines() const {
  std::vector<PlanLine> out;
  for (std::size_t i = 0; i < kStages; ++i) {
    PlanLine line;
    line.stage = static_cast<Stage>(i);
    line.on = isOn(line.stage);
    const std::optional<std::string> why = explainOff(line.stage);
    if (settings_.forced[i]) {
      line.why = "the author's choice";
    } else if (settings_.everything) {
      line.why = "every stage is kept";
    } else {
      line.why = why.value_or(explainStage(line.stage));
    }
    line.saves_ms = time_ms_[i];
    const bool costs =
        line.stage == Stage::kSmooth || line.stage == Stage::kClean || line.stage == Stage::kGrid;
    if (!line.on && costs) line.costs_N = at_rest_ ? 0.0 : cost_N_[i].value_or(0.0);
    out.push_back(line);
  }
  return out;
}

double forceDifference_N(const Relief& a, const Relief& b, double mm_per_px,
                         double stiffness_N_mm) {
  const int width = a.rect.width;
  const auto at = [width](int u, int v) {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  };
  // Distance to the tangent plane along its normal: d / (1 + g²) (-g, 1).
  const auto force = [&](const Relief& relief, int u, int v, double z_mm) {
    const auto h = [&](int i, int j) { return static_cast<double>(relief.height_mm[at(i, j)]); };
    const Vec2 g((h(u + 1, v) - h(u - 1, v)) / (2 * mm_per_px),
                 (h(u, v + 1) - h(u, v - 1)) / (2 * mm_per_px));
    const double d = std::max(0.0, h(u, v) - z_mm);
    return Vec3(Vec3(-g.x(), -g.y(), 1.0) * (stiffness_N_mm * d / (1.0 + g.squaredNorm())));
  };
  double square = 0.0;
  std::size_t count = 0;
  for (int v = 2; v + 2 < a.rect.height; ++v) {
    for (int u = 2; u + 2 < width; ++u) {
      const auto inside = [&](int i, int j) {
        return a.mask[at(i, j)] != 0 && b.mask[at(i, j)] != 0;
      };
      if (!inside(u, v) || !inside(u - 2, v) || !inside(u + 2, v) || !inside(u, v - 2) ||
          !inside(u, v + 2))
        continue;
      const double z_mm = static_cast<double>(a.height_mm[at(u, v)]) - kFinger_mm;
      square += (force(a, u, v, z_mm) - force(b, u, v, z_mm)).squaredNorm();
      ++count;
    }
  }
  return count > 0 ? std::sqrt(square / static_cast<double>(count))
                   : std::numeric_limits<double>::infinity();
}

}  // namespace hapticast::server
