// SPDX-License-Identifier: MIT
#include "server/vision/describe.hpp"

#include <algorithm>

namespace hapticast::server {

namespace {

bool equalReliefs(const Relief& a, const Relief& b) {
  return a.rect == b.rect && a.mask == b.mask && a.height_mm == b.height_mm;
}

}  // namespace

Vec3 NominalFrame::mmPerStep() const {
  const Vec2 scale = workspace.mmPerPixel();
  return {scale.x(), -scale.y(), -workspace.depth_mm / (range.far_mm - range.near_mm)};
}

Sample NominalFrame::sample(const Pose& pose, double time_s) const {
  const Vec2 plane = workspace.toNominal({pose.u_px, pose.v_px});
  const double height = (pose.depth_mm - range.far_mm) * mmPerStep().z();
  return {time_s, {plane.x(), plane.y(), height}, pose.angle_rad, pose.depth_seen};
}

void MotionHistory::add(std::uint64_t frame, double time_s,
                        const std::vector<TrackedObject>& objects) {
  for (const TrackedObject& object : objects) {
    if (object.seen) entries_[object.id].push_back({frame, time_s, object.pose, object.cells});
  }
}

void MotionHistory::dropBefore(std::uint64_t frame) {
  for (auto& [id, entries] : entries_) {
    // The last entry stays: a lost object rests there.
    while (entries.size() > 1 && entries.front().frame < frame) entries.pop_front();
  }
  std::erase_if(entries_, [&](const auto& item) {
    return item.second.back().frame + 2 * static_cast<std::uint64_t>(Tracker::kKeepLost) < frame;
  });
}

Motion MotionHistory::motion(std::uint32_t id, std::uint64_t frame, int lookahead,
                             const NominalFrame& nominal) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return {};
  std::vector<Sample> samples;
  std::optional<std::size_t> at;
  const auto reach = static_cast<std::uint64_t>(lookahead);
  for (const Entry& entry : found->second) {
    if (entry.frame + reach < frame || entry.frame > frame + reach) continue;
    if (entry.frame == frame) at = samples.size();
    samples.push_back(nominal.sample(entry.pose, entry.time_s));
  }
  Motion out;
  if (at) {
    out = motionFrom(samples, *at, lookahead);
  } else {
    const Sample rest = nominal.sample(found->second.back().pose, 0.0);
    out.position_mm = rest.position_mm;
    out.angle_rad = rest.angle_rad;
  }
  out.reference_point = ReferencePoint::kVisibleCentroid;
  return out;
}

std::shared_ptr<const MotionGrid> MotionHistory::grid(std::uint32_t id, std::uint64_t frame,
                                                      int lookahead,
                                                      const NominalFrame& nominal) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return nullptr;
  std::vector<const CellFlow*> flows;
  std::optional<std::size_t> at;
  const auto reach = static_cast<std::uint64_t>(lookahead);
  for (const Entry& entry : found->second) {
    if (entry.frame + reach < frame || entry.frame > frame + reach) continue;
    if (entry.frame == frame) at = flows.size();
    flows.push_back(&entry.cells);
  }
  return at ? gridFrom(flows, *at, nominal.mmPerStep()) : nullptr;
}

double MotionHistory::largestAcceleration_mm_s2(int lookahead, const NominalFrame& nominal) const {
  double largest = 0.0;
  const auto reach = static_cast<std::size_t>(lookahead);
  for (const auto& [id, entries] : entries_) {
    for (std::size_t i = reach; i + reach < entries.size(); ++i) {
      largest = std::max(
          largest, motion(id, entries[i].frame, lookahead, nominal).acceleration_mm_s2.norm());
    }
  }
  return largest;
}

HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings) {
  HapticObject out;
  out.id = object.id;
  out.material = settings.material;
  out.motion.quality = object.quality;
  out.motion.visible_fraction = object.visible_fraction;
  if (object.seen || last == nullptr) {
    out.relief = makeRelief(object.surface, nominal.range, nominal.workspace, settings.method);
    out.changed_in_frame = frame_id;
  }
  if (last != nullptr && (!object.seen || equalReliefs(*out.relief, *last->relief))) {
    out.relief = last->relief;
    out.changed_in_frame = last->changed_in_frame;
  }
  return out;
}

}  // namespace hapticast::server
