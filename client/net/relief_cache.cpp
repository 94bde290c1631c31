// SPDX-License-Identifier: MIT
#include "client/net/relief_cache.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace hapticast::client {

namespace {

/// Returns the height at an image point: bilinear between the pixel centres inside the mask, a
/// weighted mean at the mask's edge, nullopt outside.
std::optional<float> sampleHeight(const Relief& relief, const Vec2& image_px) {
  const double u = image_px.x() - relief.rect.u - 0.5, v = image_px.y() - relief.rect.v - 0.5;
  if (!(u > -1.0 && v > -1.0 && u < relief.rect.width && v < relief.rect.height))
    return std::nullopt;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(relief.rect.width) +
           static_cast<std::size_t>(x);
  };
  const auto inside = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < relief.rect.width && y < relief.rect.height &&
           relief.mask[at(x, y)] != 0;
  };
  if (!inside(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v))))
    return std::nullopt;
  const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
  double sum = 0.0, weights = 0.0;
  for (const int y : {top, top + 1}) {
    for (const int x : {left, left + 1}) {
      if (!inside(x, y)) continue;
      const double weight = (1.0 - std::abs(u - x)) * (1.0 - std::abs(v - y));
      sum += weight * static_cast<double>(relief.height_mm[at(x, y)]);
      weights += weight;
    }
  }
  return static_cast<float>(sum / weights);  // the nearest pixel has a weight of at least 0.25
}

/// Moves a point of an object from the pose `from` to the pose `to`.
Vec2 carryPoint(const Vec2& at_mm, const Motion& from, const Motion& to) {
  const Eigen::Rotation2Dd turn(to.angle_rad - from.angle_rad);
  return turn * (at_mm - from.position_mm.head<2>()) + to.position_mm.head<2>();
}

}  // namespace

PixelRect warpRect(const PosedRelief& before, const Motion& now, const Workspace& workspace) {
  const PixelRect& rect = before.relief->rect;
  const Vec2 picture(workspace.width_px, workspace.height_px);
  Vec2 low = picture, high = Vec2::Zero();
  for (const int u : {rect.u, rect.u + rect.width}) {
    for (const int v : {rect.v, rect.v + rect.height}) {
      const Vec2 to_mm = carryPoint(workspace.toNominal(Vec2(u, v)), before.motion, now);
      const Vec2 to = workspace.toImage(to_mm).cwiseMax(0.0).cwiseMin(picture);
      low = low.cwiseMin(to);
      high = high.cwiseMax(to);
    }
  }
  const Eigen::Vector2i first = low.array().floor().cast<int>();
  const Eigen::Vector2i size = high.array().ceil().cast<int>() - first.array();
  return {first.x(), first.y(), size.x(), size.y()};
}

void concealMissing(const PosedRelief& before, const Motion& now, const Workspace& workspace,
                    const std::vector<std::uint8_t>& have, Relief& to) {
  const Motion& then = before.motion;
  const auto raised = static_cast<float>(now.position_mm.z() - then.position_mm.z());
  std::size_t i = 0;
  for (int v = to.rect.v; v < to.rect.v + to.rect.height; ++v) {
    for (int u = to.rect.u; u < to.rect.u + to.rect.width; ++u, ++i) {
      if (have[i] != 0) continue;
      const Vec2 was_mm = carryPoint(workspace.toNominal({u + 0.5, v + 0.5}), now, then);
      const auto height = sampleHeight(*before.relief, workspace.toImage(was_mm));
      to.mask[i] = height ? 1 : 0;
      to.height_mm[i] = height ? *height + raised : 0.0F;
    }
  }
}

namespace {
// Chosen: far above the rounding on the wire.
constexpr double kHeightSlack_mm = 1.0;
}  // namespace

void ReliefCache::reset(const Workspace& workspace, Method method) {
  workspace_ = workspace;
  method_ = method;
  entries_.clear();
}

bool ReliefCache::isInPicture(const PixelRect& rect) const {
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
  if (entry.decoded) return {entry.resolved.field, entry.resolved.relief, entry.resolved.rejected};
  entry.decoded = true;
  entry.resolved = prepare(entry);
  return entry.resolved;
}

void ReliefCache::concealAll(Entry& entry, const CodedObject& object) const {
  PixelRect rect;
  if (entry.before.relief) rect = warpRect(entry.before, object.motion, workspace_);
  entry.changed_in_frame = object.changed_in_frame;
  entry.coded = std::make_shared<const CodedRelief>(CodedRelief{rect, {}, 1});
  entry.motion = object.motion;
  entry.decoded = rect.empty();  // nothing remains to be decoded
  entry.resolved = {};
}

ReliefCache::Resolved ReliefCache::prepare(Entry& entry) {
  Resolved out;
  out.rejected = !isInPicture(entry.coded->rect);
  if (out.rejected) return out;
  const auto relief = decode(entry, out);
  if (!relief) return out;
  const auto highest = std::max_element(relief->height_mm.begin(), relief->height_mm.end());
  out.rejected = *highest > workspace_.depth_mm + kHeightSlack_mm;
  if (out.rejected) return out;
  entry.before = {relief, entry.motion};
  out.relief = relief;
  if (!prepares_fields_) return out;
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
