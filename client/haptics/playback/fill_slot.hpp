// SPDX-License-Identifier: MIT
// Fills a slot of the frame pool with a frame, in the form that the loop reads.
// Thread: the producer's of the pool.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "client/haptics/playback/frame_pool.hpp"
#include "common/haptic_frame.hpp"

namespace hapticast::client {

/// Sets object number `index` of `slot` to `object` with the prepared relief `field`, which may be
/// null. An object whose motion is unknown (quality 0) keeps its shape and remains at rest. A grid
/// that does not cover the relief is dropped. Requires index < kMaxObjects.
template <class Shape>
void setObject(FramePool::Slot& slot, std::size_t index, const ObjectOf<Shape>& object,
               std::shared_ptr<const HeightField> field) {
  PlayObject play;
  play.id = object.id;
  play.layer = object.layer;
  play.changed_in_frame = object.changed_in_frame;
  play.motion = object.motion;
  play.material = object.material;
  play.field = field.get();
  slot.fields[index] = std::move(field);
  slot.grids[index].reset();
  if (object.motion.quality <= 0.0) {
    play.motion.velocity_mm_s.setZero();
    play.motion.acceleration_mm_s2.setZero();
    play.motion.angular_velocity_rad_s = 0.0;
  } else {
    play.impact_count = std::min(object.impacts.size(), kMaxImpacts);
    std::copy_n(object.impacts.begin(), play.impact_count, play.impacts.begin());
    if (play.field != nullptr && object.grid &&
        object.grid->columns == gridCells(play.field->rect().width) &&
        object.grid->rows == gridCells(play.field->rect().height)) {
      slot.grids[index] = object.grid;
      play.grid = object.grid.get();
      play.grid_rect = play.field->rect();
    }
  }
  slot.frame.objects[index] = play;
}

/// Completes a slot whose first `object_count` objects are set. `epoch` is the client-side epoch.
template <class Shape>
void completeFrame(FramePool::Slot& slot, const FrameOf<Shape>& frame, std::uint32_t epoch,
                   std::size_t object_count) {
  slot.frame.epoch = epoch;
  slot.frame.id = frame.id;
  slot.frame.media_time = frame.media_time;
  slot.frame.object_count = object_count;
  for (std::size_t i = object_count; i < kMaxObjects; ++i) {
    slot.fields[i].reset();
    slot.grids[i].reset();
  }
}

}  // namespace hapticast::client
