// SPDX-License-Identifier: MIT
#include "client/net/receiver.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

namespace {
// A pause of the stream is no jitter.
constexpr Duration kLargestGap = std::chrono::seconds(1);
}  // namespace

Receiver::Receiver(FramePool& pool, LatestValue<StreamState>& stream, ReceiverSettings settings)
    : pool_(pool), stream_(stream), settings_(settings) {}

void Receiver::startEpoch() {
  ++epoch_;
  server_epoch_.reset();
}

void Receiver::connected(const StreamDescription& description, LocalTime now) {
  clock_.reset();
  startEpoch();
  latest_.first_epoch = epoch_;
  last_id_.reset();
  described_ = false;  // whatever was announced before came over another connection
  describe(description, now);
}

void Receiver::describe(const StreamDescription& description, LocalTime now) {
  if (!described_ || !(description.workspace == latest_.workspace)) {
    reliefs_.reset(description.workspace, settings_.method);
  }
  if (!described_ || description.pipeline_latency != latest_.pipeline_latency) jitter_.reset();
  described_ = true;
  latest_.pipeline_latency = description.pipeline_latency;
  latest_.frame_interval = fromSeconds(1.0 / description.fps);
  latest_.workspace = description.workspace;
  latest_.largest_acceleration_mm_s2 = description.largest_acceleration_mm_s2;
  latest_.author_mass_kg = description.mass_kg.value_or(0.0);
  publish(now);
}

void Receiver::disconnected(LocalTime now) {
  described_ = false;
  publish(now);
}

void Receiver::pong(const Pong& pong, LocalTime arrival) {
  clock_.add(pong.t0, pong.t1, pong.t2, arrival);
  publish(arrival);
}

void Receiver::publish(LocalTime now) {
  latest_.connected = described_ && clock_.ready();
  if (latest_.connected) latest_.clock_offset = clock_.offset(now);
  latest_.playout_delay_target = jitter_.delay(latest_.frame_interval * settings_.lookahead_frames);
  stream_.store(latest_);
}

Duration Receiver::clockErrorBound() const {
  return clock_.ready() ? clock_.errorBound() : Duration::zero();
}

void Receiver::frame(HapticFrame frame, const Clock& clock) {
  if (last_id_ && frame.id <= *last_id_) {
    ++counts_.duplicates;
    return;
  }
  if (server_epoch_ != frame.epoch) {
    // The first frame after a welcome belongs to the epoch that was announced to the
    // loop.
    if (server_epoch_) ++epoch_;
    server_epoch_ = frame.epoch;
  }
  FramePool::Index index = 0;
  const bool has_slot = pool_.acquire(index);
  if (has_slot) {
    fill(pool_.slot(index), frame);
  } else {
    ++counts_.no_slot;
    // The next frames may say "unchanged" of what this one brings.
    for (const HapticObject& object : frame.objects) (void)reliefs_.resolve(object, frame.id);
  }
  // Preparing reliefs takes milliseconds in which the loop does not have the frame yet.
  const LocalTime ready = clock.now();
  observe(frame, ready);
  last_id_ = frame.id;
  last_media_time_ = frame.media_time;
  publish(ready);
  if (!has_slot) return;
  pool_.publish(index);
  ++counts_.received;
}

void Receiver::observe(const HapticFrame& frame, LocalTime ready) {
  // The first frame of a connection is sent whenever the viewer comes: its age says nothing of the
  // network.
  if (!last_id_) return;
  const std::uint64_t lost = frame.id - *last_id_ - 1;
  counts_.lost += lost;
  if (!clock_.ready()) return;
  const MediaTime media_now(ready.time_since_epoch() + clock_.offset(ready));
  const Duration lateness = media_now - frame.media_time - latest_.pipeline_latency;
  // When play time reaches the frame before, interpolation begins to need this one.
  const Duration gap = std::clamp(frame.media_time - last_media_time_, Duration{0}, kLargestGap);
  const Duration needed = lateness + gap * settings_.lookahead_frames;
  if (needed > latest_.playout_delay_target) {
    ++counts_.late;
  } else {
    counts_.concealed += lost;
  }
  jitter_.add(ready, needed);
}

void Receiver::fill(FramePool::Slot& slot, const HapticFrame& frame) {
  slot.frame.epoch = epoch_;
  slot.frame.id = frame.id;
  slot.frame.media_time = frame.media_time;
  slot.frame.object_count = std::min(frame.objects.size(), kMaxObjects);
  for (std::size_t i = 0; i < slot.frame.object_count; ++i) {
    fillObject(slot, i, frame.objects[i], frame.id);
  }
  for (std::size_t i = slot.frame.object_count; i < kMaxObjects; ++i) {
    slot.fields[i].reset();
    slot.grids[i].reset();
  }
}

namespace {

// Nothing is known of its motion: what is left is a shape that stands where it was.
void forgetMotion(PlayObject& object) {
  object.motion.velocity_mm_s.setZero();
  object.motion.acceleration_mm_s2.setZero();
  object.motion.angular_velocity_rad_s = 0.0;
  object.impact_count = 0;
}

}  // namespace

void Receiver::fillObject(FramePool::Slot& slot, std::size_t index, const HapticObject& object,
                          std::uint64_t frame_id) {
  ReliefCache::Found found = reliefs_.resolve(object, frame_id);
  if (found.rejected) ++counts_.reliefs_rejected;
  if (!found.field && !found.rejected) ++counts_.reliefs_missing;

  PlayObject& play = slot.frame.objects[index];
  play = {};
  play.id = object.id;
  play.layer = object.layer;
  play.changed_in_frame = object.changed_in_frame;
  play.motion = object.motion;
  play.material = object.material;
  play.impact_count = std::min(object.impacts.size(), kMaxImpacts);
  std::copy_n(object.impacts.begin(), play.impact_count, play.impacts.begin());

  slot.fields[index] = std::move(found.field);
  play.field = slot.fields[index].get();
  slot.grids[index].reset();
  if (object.motion.quality <= 0.0) {
    forgetMotion(play);
    return;
  }
  if (play.field == nullptr || !object.grid) return;
  const PixelRect& rect = play.field->rect();
  const auto cells = [](int px) { return (px + kGridCell_px - 1) / kGridCell_px; };
  if (object.grid->columns != cells(rect.width) || object.grid->rows != cells(rect.height)) return;
  slot.grids[index] = object.grid;
  play.grid = object.grid.get();
  play.grid_rect = rect;
}

}  // namespace hapticast::client
