// SPDX-License-Identifier: MIT
#include <stdexcept>
#include <utility>

#include "client/haptics/playback/fill_slot.hpp"
#include "client/library/haptics/renderer_impl.hpp"

namespace hapticast {

void PushFeed::begin(const StreamInfo& info) {
  // The frames that wait for their play time, and four that the interpolation holds.
  constexpr double kMostDelay = client::FramePool::kSlots - 4;
  if (delay_s_ * info.fps > kMostDelay)
    throw std::invalid_argument("delay_s: " + std::to_string(delay_s_) +
                                " s are more than 28 frames");
  importer_.emplace(info);
  prepared_.clear();
  frame_epoch_.reset();
  last_time_s_.reset();
  const StreamDescription& description = importer_->description();
  client::StreamTiming timing;
  timing.connected = true;
  timing.first_epoch = ++epoch_;
  timing.playout_delay_target = fromSeconds(delay_s_);
  timing.frame_interval = fromSeconds(1.0 / description.fps);
  timing.workspace = description.workspace;
  timing.largest_acceleration_mm_s2 = description.largest_acceleration_mm_s2;
  timing.author_mass_kg = description.mass_kg.value_or(0.0);
  feed_->timing.store(timing);
}

bool PushFeed::push(const Frame& frame) {
  if (!importer_) throw std::invalid_argument("push() needs begin() before");
  if (last_time_s_ && !(frame.time_s > *last_time_s_))
    throw std::invalid_argument("time_s: " + std::to_string(frame.time_s) +
                                " s does not follow the frame before, at " +
                                std::to_string(*last_time_s_) + " s");
  if (feed_->pool.occupied() == client::FramePool::kSlots) return false;
  const HapticFrame from = importer_->import(frame, last_id_ + 1);
  ++last_id_;
  last_time_s_ = frame.time_s;
  if (std::exchange(frame_epoch_, frame.epoch).value_or(frame.epoch) != frame.epoch) ++epoch_;
  client::FramePool::Index index = 0;
  if (!feed_->pool.acquire(index)) return false;
  client::FramePool::Slot& slot = feed_->pool.slot(index);
  std::map<ObjectKey, Prepared> prepared;
  for (std::size_t i = 0; i < from.objects.size(); ++i) {
    const HapticObject& object = from.objects[i];
    auto field = prepare(object);
    if (field) prepared[makeKey(object)] = {object.relief, field};
    client::setObject(slot, i, object, std::move(field));
  }
  prepared_ = std::move(prepared);
  client::completeFrame(slot, from, epoch_, from.objects.size());
  feed_->pool.publish(index);
  return true;
}

std::shared_ptr<const HeightField> PushFeed::prepare(const HapticObject& object) {
  if (!object.relief) return nullptr;
  const auto before = prepared_.find(makeKey(object));
  if (before != prepared_.end() && before->second.relief == object.relief)
    return before->second.field;
  const Workspace& workspace = importer_->description().workspace;
  return std::make_shared<const HeightField>(
      thesis_ ? HeightField::prepareThesis(*object.relief, workspace)
              : HeightField::prepare(*object.relief, workspace));
}

}  // namespace hapticast
