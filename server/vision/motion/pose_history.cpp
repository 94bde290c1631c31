// SPDX-License-Identifier: MIT
#include "server/vision/motion/pose_history.hpp"

#include <algorithm>

namespace hapticast::server {

std::vector<const MotionHistory::Entry*> MotionHistory::findAround(std::uint32_t id,
                                                                   std::uint64_t frame,
                                                                   int lookahead) const {
  std::vector<const Entry*> out;
  const auto entries = entries_.find(id);
  if (entries == entries_.end()) return out;
  const auto reach = static_cast<std::uint64_t>(lookahead);
  for (const Entry& entry : entries->second) {
    if (entry.frame + reach >= frame && entry.frame <= frame + reach) out.push_back(&entry);
  }
  return out;
}

void MotionHistory::dropBefore(std::uint64_t frame, std::uint64_t keep_lost) {
  for (auto& [id, entries] : entries_) {
    while (entries.size() > 1 && entries.front().frame < frame) entries.pop_front();
  }
  std::erase_if(entries_,
                [&](const auto& item) { return item.second.back().frame + keep_lost < frame; });
}

MotionWindow MotionHistory::window(std::uint32_t id, std::uint64_t frame, int lookahead,
                                   const NominalFrame& nominal) const {
  MotionWindow out;
  for (const Entry* entry : findAround(id, frame, lookahead)) {
    if (entry->frame == frame) {
      out.at = out.samples.size();
      out.point = entry->pose.point;
    }
    out.samples.push_back(nominal.sample(entry->pose, entry->time_s));
  }
  return out;
}

Motion MotionHistory::motion(std::uint32_t id, const MotionWindow& around, int lookahead,
                             const NominalFrame& nominal) const {
  const auto entries = entries_.find(id);
  if (entries == entries_.end()) return {};
  Motion out;
  if (around.at) {
    out = computeMotion(around.samples, *around.at, lookahead);
    out.reference_point = around.point;
    return out;
  }
  const ObjectPose& last = entries->second.back().pose;
  const Sample rest = nominal.sample(last, 0.0);
  out.position_mm = rest.position_mm;
  out.angle_rad = rest.angle_rad;
  out.reference_point = last.point;
  return out;
}

bool MotionHistory::hasCells(std::uint32_t id, std::uint64_t frame, int lookahead) const {
  const std::vector<const Entry*> entries = findAround(id, frame, lookahead);
  const auto measured = std::count_if(entries.begin(), entries.end(),
                                      [](const Entry* entry) { return entry->cells.columns > 0; });
  return measured == 2 * lookahead + 1;
}

std::shared_ptr<const MotionGrid> MotionHistory::grid(std::uint32_t id, std::uint64_t frame,
                                                      int lookahead,
                                                      const NominalFrame& nominal) const {
  std::vector<const CellFlow*> flows;
  std::optional<std::size_t> at;
  for (const Entry* entry : findAround(id, frame, lookahead)) {
    if (entry->frame == frame) at = flows.size();
    flows.push_back(&entry->cells);
  }
  return at ? makeMotionGrid(flows, *at, nominal.mmPerStep()) : nullptr;
}

}  // namespace hapticast::server
