// SPDX-License-Identifier: MIT
// The door for decoded frames into the 1 kHz loop: a fixed pool of slots, indices through two SPSC
// rings. The preparer fills a slot and publishes it; the loop plays it and returns it; only the
// preparer allocates or frees what a slot points to.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "common/haptic_frame.hpp"
#include "common/relief/height_field.hpp"
#include "common/sync/spsc_ring.hpp"

namespace hapticast::client {

/// One object as the loop sees it: no vectors, no ownership.
struct PlayObject {
  std::uint32_t id = 0;
  std::uint32_t layer = 0;
  std::uint64_t changed_in_frame = 0;
  const HeightField* field = nullptr;  ///< null: nothing to touch (its relief never arrived)
  const MotionGrid* grid = nullptr;
  PixelRect grid_rect;  ///< the relief's rectangle the grid covers
  Motion motion;
  std::array<Impact, kMaxImpacts> impacts{};
  std::size_t impact_count = 0;
  Material material;
};

/// What an object is known by from frame to frame.
inline std::uint64_t makeKey(const PlayObject& object) noexcept {
  return (std::uint64_t{object.id} << 32U) | object.layer;
}

/// There is something to touch; null: there is no such object.
inline bool shows(const PlayObject* object) noexcept {
  return object != nullptr && object->field != nullptr && !object->field->empty();
}

/// Nothing to blend: the same relief at the same place.
inline bool isSameRelief(const PlayObject& a, const PlayObject& b) noexcept {
  return a.field == b.field && a.motion.position_mm == b.motion.position_mm &&
         a.motion.angle_rad == b.motion.angle_rad;
}

struct PlayFrame {
  std::uint32_t epoch = 0;  ///< client-side: also new at every connection, so it never repeats
  std::uint64_t id = 0;
  MediaTime media_time;
  std::array<PlayObject, kMaxObjects> objects{};
  std::size_t object_count = 0;
};

/// The frame's object of this key; null where it (or the frame) is not there.
inline const PlayObject* findObject(const PlayFrame* frame, std::uint64_t key) noexcept {
  if (frame == nullptr) return nullptr;
  for (std::size_t i = 0; i < std::min(frame->object_count, kMaxObjects); ++i) {
    if (makeKey(frame->objects[i]) == key) return &frame->objects[i];
  }
  return nullptr;
}

class FramePool {
 public:
  static constexpr std::size_t kSlots = 32;
  using Index = std::uint32_t;
  struct Slot {
    PlayFrame frame;
    /// Keep alive what `frame` points to. Thread: preparer only.
    std::array<std::shared_ptr<const HeightField>, kMaxObjects> fields;
    std::array<std::shared_ptr<const MotionGrid>, kMaxObjects> grids;
  };

  FramePool() {
    for (Index i = 0; i < kSlots; ++i) (void)free_.tryPush(i);
  }

  // --- the preparer's side
  // -------------------------------------------------------------------------------
  /// A free slot to fill, or false when the loop holds them all (drop the frame and count it).
  [[nodiscard]] bool acquire(Index& index) noexcept { return free_.tryPop(index); }
  [[nodiscard]] Slot& slot(Index index) noexcept { return slots_[index]; }
  /// Hands a filled slot to the loop. Never full: the ring holds as many as there are slots.
  void publish(Index index) noexcept { (void)filled_.tryPush(index); }

  // --- the loop's side
  // -------------------------------------------------------------------------------
  [[nodiscard]] bool pop(Index& index) noexcept { return filled_.tryPop(index); }
  [[nodiscard]] const PlayFrame& frame(Index index) const noexcept { return slots_[index].frame; }
  void release(Index index) noexcept { (void)free_.tryPush(index); }

 private:
  std::array<Slot, kSlots> slots_;
  SpscRing<Index, kSlots> filled_;  // preparer -> loop
  SpscRing<Index, kSlots> free_;    // loop -> preparer
};

}  // namespace hapticast::client
