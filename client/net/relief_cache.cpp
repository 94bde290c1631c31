// SPDX-License-Identifier: MIT
#include "client/net/relief_cache.hpp"

#include <algorithm>

namespace hapticast::client {

namespace {
constexpr double kHeightSlack_mm = 1.0;
}

void ReliefCache::reset(const Workspace& workspace, Method method) {
  workspace_ = workspace;
  method_ = method;
  entries_.clear();
}

bool ReliefCache::fits(const Relief& relief) const {
  const PixelRect& rect = relief.rect;
  if (rect.empty() || rect.u < 0 || rect.v < 0 || rect.u + rect.width > workspace_.width_px ||
      rect.v + rect.height > workspace_.height_px) {
    return false;
  }
  const auto highest = std::max_element(relief.height_mm.begin(), relief.height_mm.end());
  return *highest <= workspace_.depth_mm + kHeightSlack_mm;
}

ReliefCache::Found ReliefCache::resolve(const HapticObject& object, std::uint64_t frame_id) {
  const auto known = entries_.find({object.id, object.layer});
  if (known != entries_.end() && known->second.changed_in_frame == object.changed_in_frame) {
    known->second.used_in_frame = frame_id;
    return {known->second.field, false};
  }
  if (!object.relief) return {};
  if (!fits(*object.relief)) return {nullptr, true};
  auto field = std::make_shared<const HeightField>(
      method_ == Method::kThesis ? HeightField::prepareThesis(*object.relief, workspace_)
                                 : HeightField::prepare(*object.relief, workspace_));
  entries_[{object.id, object.layer}] = {object.changed_in_frame, frame_id, field};
  if (entries_.size() > kMaxEntries) forgetOldest();
  return {field, false};
}

void ReliefCache::forgetOldest() {
  entries_.erase(
      std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
        return a.second.used_in_frame < b.second.used_in_frame;
      }));
}

}  // namespace hapticast::client
