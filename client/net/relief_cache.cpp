// SPDX-License-Identifier: MIT
#include "client/net/relief_cache.hpp"

#include <algorithm>

namespace hapticast::client {

namespace {
// Chosen: what rounding on the wire can add is far below it.
constexpr double kHeightSlack_mm = 1.0;
}  // namespace

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

bool ReliefCache::remember(const HapticObject& object, std::uint64_t frame_id) {
  const auto known = entries_.find({object.id, object.layer});
  if (known != entries_.end() && known->second.changed_in_frame == object.changed_in_frame) {
    known->second.used_in_frame = frame_id;
    return true;
  }
  if (!object.relief) return true;
  if (known != entries_.end() && *known->second.raw == *object.relief) {
    known->second.changed_in_frame = object.changed_in_frame;
    known->second.used_in_frame = frame_id;
    return true;
  }
  if (!fits(*object.relief)) return false;
  entries_[{object.id, object.layer}] = {object.changed_in_frame, frame_id, object.relief, nullptr};
  if (entries_.size() > kMaxEntries) forgetOldest();
  return true;
}

ReliefCache::Resolved ReliefCache::resolve(const HapticObject& object, std::uint64_t frame_id) {
  if (!remember(object, frame_id)) return {nullptr, true};
  const auto known = entries_.find({object.id, object.layer});
  if (known == entries_.end() || known->second.changed_in_frame != object.changed_in_frame) {
    return {};  // said to be unchanged, but it never came
  }
  Entry& entry = known->second;
  if (!entry.field) {
    entry.field = std::make_shared<const HeightField>(
        method_ == Method::kThesis ? HeightField::prepareThesis(*entry.raw, workspace_)
                                   : HeightField::prepare(*entry.raw, workspace_));
  }
  return {entry.field, false};
}

void ReliefCache::forgetOldest() {
  entries_.erase(
      std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
        return a.second.used_in_frame < b.second.used_in_frame;
      }));
}

}  // namespace hapticast::client
