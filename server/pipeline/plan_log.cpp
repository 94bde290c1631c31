// SPDX-License-Identifier: MIT
#include "server/pipeline/plan_log.hpp"

#include <spdlog/spdlog.h>
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace hapticast::server {

namespace {

// Chosen: more than the plans of a loop's round.
constexpr std::size_t kMostRetired = 256;
constexpr Duration kSameAgain = std::chrono::minutes(1);

std::string removeFigures(std::string text) {
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  return text;
}

/// Returns whether two plans decide equally; different figures in a reason do not count.
bool areSameDecisions(const std::vector<PlanLine>& a, const std::vector<PlanLine>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const PlanLine& x, const PlanLine& y) {
                      return x.on == y.on && removeFigures(x.why) == removeFigures(y.why);
                    });
}

void logLine(std::uint32_t id, const PlanLine& line, std::size_t relief_bytes) {
  const std::string_view stage = kStageNames[static_cast<std::size_t>(line.stage)];
  if (line.on) {
    spdlog::info("object {}: {:<8} on   {}; needs {:.1f} ms a frame", id, stage, line.why,
                 line.saves_ms);
  } else {
    const std::size_t bytes = line.stage == Stage::kHeights ? relief_bytes : 0;
    spdlog::info("object {}: {:<8} off  {}; saves {:.1f} ms and {} bytes a frame, costs {:.4f} N",
                 id, stage, line.why, line.saves_ms, bytes, line.costs_N);
  }
}

}  // namespace

void PlanLog::log(const std::map<std::uint32_t, std::vector<PlanLine>>& plans,
                  const ReliefBytes& relief_bytes, MediaTime now) {
  for (auto each = logged_.begin(); each != logged_.end();) {
    if (plans.contains(each->first)) {
      ++each;
    } else {
      retire(std::move(each->second));
      each = logged_.erase(each);
    }
  }
  for (const auto& [id, lines] : plans) {
    LoggedPlan& logged = logged_[id];
    const bool too_soon = !logged.lines.empty() && now - logged.at < std::chrono::seconds(1);
    if (too_soon || areSameDecisions(lines, logged.lines)) continue;
    logged.lines = lines;
    if (!isNews(logged, now)) continue;
    logged.at = now;
    const auto bytes = relief_bytes.find(id);
    for (const PlanLine& line : lines)
      logLine(id, line, bytes == relief_bytes.end() ? 0 : bytes->second);
  }
}

bool PlanLog::isNews(LoggedPlan& logged, MediaTime now) const {
  const auto same = [&logged](const Lines& lines) { return areSameDecisions(logged.lines, lines); };
  if (std::any_of(retired_.begin(), retired_.end(), same)) return false;
  const auto before = std::find_if(logged.all.begin(), logged.all.end(),
                                   [&](const LoggedLines& each) { return same(each.lines); });
  if (before == logged.all.end()) {
    logged.all.push_back({logged.lines, now});
    return true;
  }
  if (now - before->at < kSameAgain) return false;
  before->at = now;
  return true;
}

void PlanLog::retire(LoggedPlan plan) {
  for (LoggedLines& each : plan.all) retired_.push_back(std::move(each.lines));
  while (retired_.size() > kMostRetired) retired_.pop_front();
}

void DepthRangeLog::log(const std::optional<MappedRange>& mapped) {
  if (logged_ || !mapped) return;
  logged_ = true;
  const DepthRange& range = mapped->range;
  if (mapped->usual_mm <= 0) {
    spdlog::info("depths of {:.0f} to {:.0f} mm become heights, as specified", range.near_mm,
                 range.far_mm);
    return;
  }
  spdlog::info(
      "depths of {:.0f} to {:.0f} mm become heights; in a usual frame the object covers {:.0f} mm",
      range.near_mm, range.far_mm, mapped->usual_mm);
  if (!mapped->wide) return;
  spdlog::warn(
      "the object covers {:.0f} % of the heights: it moves in depth, or its mask includes other "
      "things; --not U,V on a pixel of the other things, or --map-range NEAR,FAR, makes the object "
      "taller",
      100.0 * mapped->usual_mm / (range.far_mm - range.near_mm));
}

}  // namespace hapticast::server
