// SPDX-License-Identifier: MIT
#include "server/vision/describe.hpp"

#include <algorithm>
#include <cmath>

namespace hapticast::server {

namespace {

constexpr double kHighQuantile = 0.99;
constexpr double kUsualStiffness_N_mm = 0.5;
constexpr double kStep_mm = 3.0;  // nominal: the least that is felt as a gap

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
  const Vec3 step = mmPerStep();
  return {.time_s = time_s,
          .position_mm = {plane.x(), plane.y(), height},
          .angle_rad = pose.angle_rad,
          .depth_seen = pose.depth_seen,
          .seen = pose.seen,
          .sure = pose.sure,
          .background_mm = {step.x() * pose.background_px[0], step.y() * pose.background_px[1], 0}};
}

void MotionHistory::add(std::uint64_t frame, double time_s,
                        const std::vector<TrackedObject>& objects) {
  for (const TrackedObject& object : objects) {
    if (object.seen)
      entries_[object.id].push_back({frame, time_s, object.pose, object.cells, object.quality});
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

MotionHistory::Window MotionHistory::window(std::uint32_t id, std::uint64_t frame, int lookahead,
                                            const NominalFrame& nominal) const {
  Window out;
  const auto found = entries_.find(id);
  if (found == entries_.end()) return out;
  const auto reach = static_cast<std::uint64_t>(lookahead);
  for (const Entry& entry : found->second) {
    if (entry.frame + reach < frame || entry.frame > frame + reach) continue;
    if (entry.frame == frame) {
      out.at = out.samples.size();
      out.point = entry.pose.point;
    }
    out.samples.push_back(nominal.sample(entry.pose, entry.time_s));
  }
  return out;
}

Motion MotionHistory::motion(std::uint32_t id, const Window& around, int lookahead,
                             const NominalFrame& nominal) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return {};
  Motion out;
  if (around.at) {
    out = motionFrom(around.samples, *around.at, lookahead);
  } else {
    const Sample rest = nominal.sample(found->second.back().pose, 0.0);
    out.position_mm = rest.position_mm;
    out.angle_rad = rest.angle_rad;
  }
  out.reference_point = (around.at ? around.point : found->second.back().pose.point);
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

bool MotionHistory::hasCells(std::uint32_t id, std::uint64_t frame, int lookahead) const {
  const auto found = entries_.find(id);
  if (found == entries_.end()) return false;
  const auto reach = static_cast<std::uint64_t>(lookahead);
  std::uint64_t frames = 0;
  for (const Entry& entry : found->second) {
    if (entry.frame + reach >= frame && entry.frame <= frame + reach && entry.cells.columns > 0)
      ++frames;
  }
  return frames == 2 * reach + 1;
}

double largestAcceleration_mm_s2(std::vector<double>& accelerations_mm_s2) {
  if (accelerations_mm_s2.empty()) return 0.0;
  const auto last = static_cast<double>(accelerations_mm_s2.size() - 1);
  const auto high = accelerations_mm_s2.begin() + std::lround(kHighQuantile * last);
  std::nth_element(accelerations_mm_s2.begin(), high, accelerations_mm_s2.end());
  return *high;
}

namespace {

std::shared_ptr<const Relief> reliefOf(const TrackedObject& object, const NominalFrame& nominal,
                                       const VisionSettings& settings) {
  ScenePlan& plan = *object.plan;
  const auto make = [&](bool smooth) {
    return makeRelief(object.surface, nominal.range, nominal.workspace, settings.method, smooth);
  };
  if (settings.method == Method::kThesis) return make(true);
  const bool smooth = plan.on(Stage::kSmooth);
  if (!smooth && !plan.measureNow()) return make(false);
  std::shared_ptr<const Relief> smoothed;
  {
    const Lap lap(settings.clock, plan, Stage::kSmooth);
    smoothed = make(true);
  }
  plan.relief(2 * smoothed->height_mm.size());
  if (plan.measureNow()) {
    const double stiffness = settings.material.stiffness_N_mm;
    plan.costs(Stage::kSmooth,
               forceDifference_N(*smoothed, *make(false), nominal.workspace.mmPerPixel().x(),
                                 stiffness > 0 ? stiffness : kUsualStiffness_N_mm));
  }
  return smoothed;
}

}  // namespace

HapticObject describeObject(const TrackedObject& object, std::uint64_t frame_id,
                            const HapticObject* last, const NominalFrame& nominal,
                            const VisionSettings& settings) {
  HapticObject out;
  out.id = object.id;
  out.material = settings.material;
  out.motion.quality = object.quality;
  out.motion.visible_fraction = object.visible_fraction;
  const bool stays = last != nullptr && (!object.seen || object.atRest());
  if (!stays || (object.seen && object.plan->on(Stage::kHeights))) {
    out.relief = reliefOf(object, nominal, settings);
    out.changed_in_frame = frame_id;
  }
  const bool unchanged = last != nullptr && (stays || equalReliefs(*out.relief, *last->relief));
  object.plan->unchanged(unchanged);
  if (unchanged && (!out.relief || !object.plan->on(Stage::kHeights))) {
    out.relief = last->relief;
    out.changed_in_frame = last->changed_in_frame;
  }
  return out;
}

std::vector<HapticObject> describeLayers(const TrackedObject& object, std::uint64_t frame_id,
                                         const std::vector<HapticObject>& last,
                                         const DepthNoise& noise, const NominalFrame& nominal,
                                         const VisionSettings& settings, LayerCutter& cutter) {
  std::vector<const HapticObject*> before(kMaxLayers, nullptr);
  for (const HapticObject& other : last) {
    if (other.id == object.id && other.layer < before.size()) before[other.layer] = &other;
  }
  std::vector<HapticObject> out;
  const auto add = [&](const TrackedObject& part, std::uint32_t layer) {
    out.push_back(describeObject(part, frame_id, before[layer], nominal, settings));
    out.back().layer = layer;
  };
  const bool known = std::any_of(before.begin(), before.end(), [](const auto* o) { return o; });
  const bool kept = object.atRest() && !object.plan->on(Stage::kHeights);
  if (known && (!object.seen || kept)) {
    for (std::uint32_t layer = 0; layer < before.size(); ++layer) {
      if (before[layer] != nullptr) add(object, layer);
    }
    return out;
  }
  if (settings.method == Method::kThesis) {
    add(object, 0);
    return out;
  }
  const double step_mm =
      std::max(noise.step_mm(object.pose.depth_mm), kStep_mm / std::abs(nominal.mmPerStep().z()));
  std::uint32_t layer = 0;
  TrackedObject part = object;
  for (Surface& surface : cutter.cut(object.surface, step_mm)) {
    part.surface = std::move(surface);
    if (!part.surface.box.empty()) add(part, layer);
    ++layer;
  }
  return out;
}

}  // namespace hapticast::server
