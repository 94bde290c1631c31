// SPDX-License-Identifier: MIT
#include "server/source/video/frame_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace hapticast::server {

namespace {

constexpr double kMost_s = 1e6;  // chosen: 11 days; times from outside may be anything

/// Returns the period of frames without a gap, from the steps between frames. Requires a step.
double findPeriod_s(const std::vector<double>& steps_s) {
  // The lower quartile: up to three of four steps may be gaps.
  std::vector<double> sorted = steps_s;
  const auto quarter = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) / 4);
  std::nth_element(sorted.begin(), quarter, sorted.end());
  const double short_s = *quarter;
  // Containers round times (Matroska to 1 ms), so the mean of the steps like it is more exact.
  double sum_s = 0.0;
  double count = 0.0;
  for (const double step_s : steps_s) {
    if (std::abs(step_s - short_s) > 0.25 * short_s) continue;
    sum_s += step_s;
    count += 1.0;
  }
  return sum_s / count;
}

}  // namespace

FrameTimes describeTimes(std::vector<double> times_s) {
  FrameTimes out;
  if (times_s.size() < 2) return out;
  out.start_s = times_s.front();
  for (double& time_s : times_s) time_s -= out.start_s;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) steps_s.push_back(times_s[i] - times_s[i - 1]);
  const double period_s = findPeriod_s(steps_s);
  if (!(period_s > 0.0)) return out;
  double slots = 0.0;
  for (const double step_s : steps_s) slots += std::max(1.0, std::round(step_s / period_s));
  out.fps = slots / times_s.back();
  if (!(out.fps >= 1.0 && out.fps <= 240.0) || times_s.back() > kMost_s) return out;
  out.has_gaps = slots > static_cast<double>(steps_s.size());
  out.times_s = std::move(times_s);
  return out;
}

bool belongByTime(const FrameTimes& color, const FrameTimes& depth) {
  if (!color.usable() || !depth.usable()) return false;
  if (color.times_s.size() == depth.times_s.size() && !(color.has_gaps && depth.has_gaps))
    return false;
  const double frames = std::abs(static_cast<double>(color.times_s.size()) -
                                 static_cast<double>(depth.times_s.size()));
  const double seconds = std::abs(color.duration_s() - depth.duration_s());
  // A program that makes depth frame by frame forgets the gaps of the colour.
  constexpr double kFewFrames = 5.5;  // chosen, as for the lengths of pairs
  const bool made_by_frame = frames <= kFewFrames && seconds * color.fps > kFewFrames;
  if (color.has_gaps || depth.has_gaps) return !made_by_frame;
  return seconds * color.fps + 0.5 < frames;
}

LoneFrames findLone(const FrameTimes& times, const FrameTimes& others) {
  LoneFrames lone;
  for (const double time_s : times.times_s) {
    if (std::abs(nearestTime_s(others.times_s, time_s) - time_s) <= others.tolerance_s()) continue;
    if (lone.count++ == 0) lone.first_s = time_s;
  }
  return lone;
}

double nearestTime_s(const std::vector<double>& times_s, double time_s) {
  const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s);
  if (after == times_s.begin()) return *after;
  const double before_s = *(after - 1);
  return after == times_s.end() || time_s - before_s <= *after - time_s ? before_s : *after;
}

}  // namespace hapticast::server
