// SPDX-License-Identifier: MIT
#include "server/pipeline/plan_log.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "recording.pb.h"

namespace hapticast::server {

namespace {

constexpr Duration kLeastPause = std::chrono::seconds(1);  // chosen: a readable log
constexpr Duration kSameAgain = std::chrono::minutes(1);

/// Returns the decisions of a plan as a text; different figures in a reason do not count.
std::string describeDecisions(const std::vector<PlanLine>& lines) {
  std::string text;
  for (const PlanLine& line : lines) text += (line.on ? "on " : "off ") + line.why + '\n';
  std::erase_if(text, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  return text;
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
  logged_.resize(std::max(logged_.size(), plans.size()));
  auto logged = logged_.begin();
  for (const auto& [id, lines] : plans) {
    Logged& place = *logged++;
    std::string decisions = describeDecisions(lines);
    if (decisions == place.newest || (place.at && now - *place.at < kLeastPause)) continue;
    place.newest = std::move(decisions);
    const auto [before, is_new] = place.times.try_emplace(place.newest, now);
    if (!is_new && now - before->second < kSameAgain) continue;
    before->second = now;
    place.at = now;
    const auto bytes = relief_bytes.find(id);
    for (const PlanLine& line : lines)
      logLine(id, line, bytes == relief_bytes.end() ? 0 : bytes->second);
  }
}

std::vector<std::uint8_t> encodePlan(const std::map<std::uint32_t, std::vector<PlanLine>>& plans) {
  proto::Plan plan;
  for (const auto& [id, lines] : plans) {
    for (const PlanLine& line : lines) {
      proto::Plan::Stage& stage = *plan.add_stages();
      stage.set_object(id);
      stage.set_stage(std::string(kStageNames[static_cast<std::size_t>(line.stage)]));
      stage.set_on(line.on);
      stage.set_why(line.why);
      stage.set_time_ms(line.saves_ms);
      stage.set_cost_n(line.costs_N);
    }
  }
  std::vector<std::uint8_t> bytes(plan.ByteSizeLong());
  plan.SerializeWithCachedSizesToArray(bytes.data());
  return bytes;
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
