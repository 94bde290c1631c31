// SPDX-License-Identifier: MIT
#include "common/library/frame_export.hpp"

#include <utility>

namespace hapticast {

StreamInfo exportInfo(const StreamDescription& description) {
  const Workspace& workspace = description.workspace;
  StreamInfo to;
  to.name = description.name;
  to.fps = description.fps;
  to.width_px = workspace.width_px;
  to.height_px = workspace.height_px;
  to.width_mm = workspace.width_mm;
  to.height_mm = workspace.height_mm;
  to.depth_mm = workspace.depth_mm;
  to.thesis = description.method == Method::kThesis;
  to.stretch = workspace.stretch;
  to.latency_s = toSeconds(description.pipeline_latency);
  to.max_acceleration_mm_s2 = description.largest_acceleration_mm_s2;
  to.mass_kg = description.mass_kg;
  return to;
}

std::shared_ptr<const HeightMap> exportHeights(const Relief& relief) {
  auto to = std::make_shared<HeightMap>();
  to->left_px = relief.rect.u;
  to->top_px = relief.rect.v;
  to->width_px = relief.rect.width;
  to->height_px = relief.rect.height;
  to->height_mm = relief.height_mm;
  to->mask = relief.mask;
  return to;
}

Frame FrameExporter::convert(const HapticFrame& frame) {
  Frame to;
  to.id = frame.id;
  to.epoch = frame.epoch;
  to.time_s = toSeconds(frame.media_time);
  std::map<ObjectKey, Known> known;
  for (const HapticObject& object : frame.objects) {
    Object& made = to.objects.emplace_back(exportObject(object));
    if (!object.relief) continue;
    const auto before = known_.find(makeKey(object));
    const bool unchanged = before != known_.end() && before->second.relief == object.relief;
    made.heights = unchanged ? before->second.heights : exportHeights(*object.relief);
    known.insert_or_assign(makeKey(object), Known{object.relief, made.heights});
  }
  known_ = std::move(known);
  return to;
}

}  // namespace hapticast
