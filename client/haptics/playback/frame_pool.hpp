// SPDX-License-Identifier: MIT
// Object pool for decoded frames. It has a fixed number of slots, and two SPSC rings that carry
// slot indices between two threads. The decode thread fills a slot and publishes it to the loop.
// The loop plays the frame in the slot, and then returns the slot to the decode thread.
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

/// Weak references to the reliefs of one frame, for the views. A reference expires when neither a
/// slot nor the relief cache owns the relief any more. Thread: any.
struct PlayableReliefs {
  MediaTime media_time;
  std::vector<std::weak_ptr<const HeightField>> reliefs;  ///< one for each object
};

/// One object of a frame, in the form that the loop reads: no vectors, and no ownership of the
/// data.
struct PlayObject {
  std::uint32_t id = 0;
  std::uint32_t layer = 0;
  std::uint64_t changed_in_frame = 0;
  const HeightField* field = nullptr;  ///< null if the relief of the object never arrived
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

/// Returns true if `object` has a relief that can be touched. `object` may be null.
inline bool shows(const PlayObject* object) noexcept {
  return object != nullptr && object->field != nullptr && !object->field->empty();
}

/// Returns true if both objects have the same relief at the same position and angle. Then there is
/// nothing to blend between them.
inline bool isSameRelief(const PlayObject& a, const PlayObject& b) noexcept {
  return a.field == b.field && a.motion.position_mm == b.motion.position_mm &&
         a.motion.angle_rad == b.motion.angle_rad;
}

/// One frame, in the form that the loop reads.
struct PlayFrame {
  /// Client-side epoch. Unlike the server's epoch it also changes at every connection, so no value
  /// repeats.
  std::uint32_t epoch = 0;
  std::uint64_t id = 0;
  MediaTime media_time;
  std::array<PlayObject, kMaxObjects> objects{};
  std::size_t object_count = 0;
};

/// Returns the object of `frame` with this key. Returns null if `frame` is null or has no such
/// object.
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
    /// Owners of the data that `frame` points to. Only the decode thread uses them.
    std::array<std::shared_ptr<const HeightField>, kMaxObjects> fields;
    std::array<std::shared_ptr<const MotionGrid>, kMaxObjects> grids;
  };

  FramePool() {
    for (Index i = 0; i < kSlots; ++i) (void)free_.tryPush(i);
  }

  // Side of the decode thread.

  /// Removes a free slot from the pool and writes its index to `index`. Returns false if no slot is
  /// free. The caller then has to drop its frame and count it as dropped. The call frees the data
  /// of all slots that the loop has released.
  [[nodiscard]] bool acquire(Index& index) noexcept {
    clearReleased();
    if (empty_count_ == 0) return false;
    index = empty_[--empty_count_];
    return true;
  }
  /// Returns the number of occupied slots. The call frees the data of all slots that the loop has
  /// released.
  [[nodiscard]] std::size_t occupied() noexcept {
    clearReleased();
    return kSlots - empty_count_;
  }
  /// Returns the bytes of the reliefs that the slots own. A relief of several slots counts once.
  [[nodiscard]] std::size_t bytes() const noexcept {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < kSlots * kMaxObjects; ++i) {
      const HeightField* const field = findField(i);
      bool counted = field == nullptr;
      for (std::size_t k = i; !counted && k-- > 0;) counted = findField(k) == field;
      if (!counted) sum += field->bytes();
    }
    return sum;
  }
  /// Returns an acquired slot, for the decode thread to fill.
  [[nodiscard]] Slot& slot(Index index) noexcept { return slots_[index]; }
  /// Passes a filled slot to the loop. The call cannot fail, because the ring has room for all
  /// slots.
  void publish(Index index) noexcept { (void)filled_.tryPush(index); }

  // Side of the loop.

  /// Writes the index of the oldest filled slot to `index`. Returns false if there is none.
  [[nodiscard]] bool pop(Index& index) noexcept {
    const bool popped = filled_.tryPop(index);
    taken_ += popped ? 1 : 0;
    return popped;
  }
  /// Returns the number of slots that pop() has returned.
  [[nodiscard]] std::uint64_t taken() const noexcept { return taken_; }
  /// Returns the frame in a filled slot. It is valid until release().
  [[nodiscard]] const PlayFrame& frame(Index index) const noexcept { return slots_[index].frame; }
  /// Returns a slot to the decode thread, which may fill it again.
  void release(Index index) noexcept { (void)free_.tryPush(index); }

 private:
  void clearReleased() noexcept {
    Index released = 0;
    while (free_.tryPop(released)) {
      slots_[released].fields.fill(nullptr);
      slots_[released].grids.fill(nullptr);
      empty_[empty_count_++] = released;
    }
  }
  [[nodiscard]] const HeightField* findField(std::size_t i) const noexcept {
    return slots_[i / kMaxObjects].fields[i % kMaxObjects].get();
  }

  std::array<Slot, kSlots> slots_;
  SpscRing<Index, kSlots> filled_;     // decode thread -> loop
  SpscRing<Index, kSlots> free_;       // loop -> decode thread
  std::array<Index, kSlots> empty_{};  // free slots without data; decode thread only
  std::size_t empty_count_ = 0;
  std::uint64_t taken_ = 0;  // loop only
};

}  // namespace hapticast::client
