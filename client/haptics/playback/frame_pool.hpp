// SPDX-License-Identifier: MIT
// Object pool for decoded frames: a fixed number of slots, and two SPSC rings that carry slot
// indices. The decode thread fills a slot and publishes it. The loop plays the slot and releases
// it.
//
// Only the decode thread allocates or frees the data that a slot points to.
// Threads: decode thread (producer), loop (consumer).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/haptic_frame.hpp"
#include "common/relief/height_field.hpp"
#include "common/sync/spsc_ring.hpp"
#include "common/time.hpp"

namespace hapticast::client {

// The reliefs of a frame that the loop can touch, for the views.
// Thread: any.

/// Weak references: a relief exists as long as the loop may play its frame.
struct PlayableReliefs {
  MediaTime media_time;
  std::vector<std::weak_ptr<const HeightField>> reliefs;  ///< one for each object
};

/// One object of a frame for the loop, without vectors and without ownership.
struct PlayObject {
  std::uint32_t id = 0;
  std::uint32_t layer = 0;
  std::uint64_t changed_in_frame = 0;
  const HeightField* field = nullptr;  ///< null: no relief, because it never arrived
  const MotionGrid* grid = nullptr;
  PixelRect grid_rect;  ///< rectangle of the relief that the grid covers
  Motion motion;
  std::array<Impact, kMaxImpacts> impacts{};
  std::size_t impact_count = 0;
  Material material;
};

/// Returns the key that identifies an object across frames: id and layer.
inline std::uint64_t makeKey(const PlayObject& object) noexcept {
  return (std::uint64_t{object.id} << 32U) | object.layer;
}

/// Returns true if `object` has a relief to touch. `object` may be null.
inline bool shows(const PlayObject* object) noexcept {
  return object != nullptr && object->field != nullptr && !object->field->empty();
}

/// Returns true if both frames have the same relief at the same place, so that there is nothing to
/// blend.
inline bool isSameRelief(const PlayObject& a, const PlayObject& b) noexcept {
  return a.field == b.field && a.motion.position_mm == b.motion.position_mm &&
         a.motion.angle_rad == b.motion.angle_rad;
}

/// One frame for the loop.
struct PlayFrame {
  /// Client-side epoch: new at every connection as well, so it never repeats.
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;
  MediaTime media_time;
  std::array<PlayObject, kMaxObjects> objects{};
  std::size_t object_count = 0;
};

/// Returns the frame's object with this key; null if `frame` is null or has no such object.
inline const PlayObject* findObject(const PlayFrame* frame, std::uint64_t key) noexcept {
  if (frame == nullptr) return nullptr;
  for (std::size_t i = 0; i < std::min(frame->object_count, kMaxObjects); ++i) {
    if (makeKey(frame->objects[i]) == key) return &frame->objects[i];
  }
  return nullptr;
}

/// The pool. Its functions do not block and do not allocate.
class FramePool {
 public:
  static constexpr std::size_t kSlots = 32;
  using Index = std::uint32_t;
  struct Slot {
    PlayFrame frame;
    /// Owners of the data that `frame` points to. Thread: decode thread.
    std::array<std::shared_ptr<const HeightField>, kMaxObjects> fields;
    std::array<std::shared_ptr<const MotionGrid>, kMaxObjects> grids;
  };

  FramePool() {
    for (Index i = 0; i < kSlots; ++i) (void)free_.tryPush(i);
  }

  // Side of the decode thread.

  /// Fetches a free slot. Returns false if the loop holds all slots: drop the frame and count it.
  [[nodiscard]] bool acquire(Index& index) noexcept { return free_.tryPop(index); }
  [[nodiscard]] Slot& slot(Index index) noexcept { return slots_[index]; }
  /// Passes a filled slot to the loop. Always succeeds, because the ring has room for all slots.
  void publish(Index index) noexcept { (void)filled_.tryPush(index); }

  // Side of the loop.

  /// Fetches a filled slot. Returns false if there is none.
  [[nodiscard]] bool pop(Index& index) noexcept { return filled_.tryPop(index); }
  [[nodiscard]] const PlayFrame& frame(Index index) const noexcept { return slots_[index].frame; }
  /// Returns a slot to the decode thread.
  void release(Index index) noexcept { (void)free_.tryPush(index); }

 private:
  std::array<Slot, kSlots> slots_;
  SpscRing<Index, kSlots> filled_;  // decode thread -> loop
  SpscRing<Index, kSlots> free_;    // loop -> decode thread
};

}  // namespace hapticast::client
