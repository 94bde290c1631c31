// SPDX-License-Identifier: MIT
#include "client/net/relief_cache.hpp"

#include <algorithm>

namespace hapticast::client {

namespace {
// Chosen: far above the rounding on the wire.
constexpr double kHeightSlack_mm = 1.0;
}  // namespace

void ReliefCache::reset(const Workspace& workspace, Method method) {
  workspace_ = workspace;
  method_ = method;
  entries_.clear();
}

bool ReliefCache::inPicture(const PixelRect& rect) const {
  return !rect.empty() && rect.u >= 0 && rect.v >= 0 &&
         rect.u + rect.width <= workspace_.width_px && rect.v + rect.height <= workspace_.height_px;
}

void ReliefCache::remember(const CodedObject& object, std::uint64_t frame_id) {
  const auto found = entries_.find(makeKey(object));
  Entry* const known = found == entries_.end() ? nullptr : &found->second;
  // A repeated relief may have slices that were lost the first time.
  const bool same =
      known != nullptr && (object.relief && !(known->changed_in_frame == object.changed_in_frame &&
                                              known->coded->whole())
                               ? *known->coded == *object.relief
                               : known->changed_in_frame == object.changed_in_frame);
  if (same) {
    known->changed_in_frame = object.changed_in_frame;
    known->used_in_frame = frame_id;
    return;
  }
  if (!object.relief) return;
  Entry entry{object.changed_in_frame, frame_id, object.relief, object.motion, {}, false, {}};
  if (known != nullptr) entry.before = known->before;
  entries_[makeKey(object)] = std::move(entry);
  if (entries_.size() > kMaxEntries) forgetOldest();
}

ReliefCache::Resolved ReliefCache::resolve(const CodedObject& object, std::uint64_t frame_id) {
  remember(object, frame_id);
  const auto known = entries_.find(makeKey(object));
  if (known == entries_.end()) return {};  // declared unchanged, but never received
  Entry& entry = known->second;
  if (entry.changed_in_frame != object.changed_in_frame) {
    concealAll(entry, object);
    entry.used_in_frame = frame_id;
  }
  if (entry.decoded) return {entry.resolved.field, entry.resolved.rejected};
  entry.decoded = true;
  entry.resolved = prepare(entry);
  return entry.resolved;
}

void ReliefCache::concealAll(Entry& entry, const CodedObject& object) const {
  PixelRect rect;
  if (entry.before.relief) rect = warpedRect(entry.before, object.motion, workspace_);
  entry.changed_in_frame = object.changed_in_frame;
  entry.coded = std::make_shared<const CodedRelief>(CodedRelief{rect, {}, 1});
  entry.motion = object.motion;
  entry.decoded = rect.empty();  // nothing remains to be decoded
  entry.resolved = {};
}

ReliefCache::Resolved ReliefCache::prepare(Entry& entry) {
  Resolved out;
  out.rejected = !inPicture(entry.coded->rect);
  if (out.rejected) return out;
  const auto relief = decode(entry, out);
  if (!relief) return out;
  const auto highest = std::max_element(relief->height_mm.begin(), relief->height_mm.end());
  out.rejected = *highest > workspace_.depth_mm + kHeightSlack_mm;
  if (out.rejected) return out;
  entry.before = {relief, entry.motion};
  out.field = std::make_shared<const HeightField>(
      method_ == Method::kThesis ? HeightField::prepareThesis(*relief, workspace_)
                                 : HeightField::prepare(*relief, workspace_));
  return out;
}

std::shared_ptr<const Relief> ReliefCache::decode(const Entry& entry, Resolved& counts) {
  const CodedRelief& coded = *entry.coded;
  const auto relief = std::make_shared<Relief>(Relief::blank(coded.rect));
  std::vector<std::uint8_t> have(coded.rect.pixels(), 0);
  for (const SliceBytes& slice : coded.slices) {
    const auto covered = decoder_.decode(slice, *relief);
    if (!covered.ok()) {
      ++counts.slices_refused;
      continue;
    }
    const PixelRect& part = covered.value();
    for (int v = part.v; v < part.v + part.height; ++v)
      std::fill_n(have.begin() + std::ptrdiff_t{v} * coded.rect.width + part.u, part.width, 1);
  }
  counts.slices_lost = coded.slice_count - coded.slices.size();
  if (counts.slices_lost + counts.slices_refused == 0) return relief;
  if (!entry.before.relief) return nullptr;
  concealMissing(entry.before, entry.motion, workspace_, have, *relief);
  const auto inside = std::find(relief->mask.begin(), relief->mask.end(), 1);
  return inside == relief->mask.end() ? nullptr : relief;
}

void ReliefCache::forgetOldest() {
  entries_.erase(
      std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
        return a.second.used_in_frame < b.second.used_in_frame;
      }));
}

}  // namespace hapticast::client
