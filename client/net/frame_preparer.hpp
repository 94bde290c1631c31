// SPDX-License-Identifier: MIT
// Preparation of received frames for the loop: decodes the reliefs of a frame, prepares them as
// height fields, and publishes the frame to the loop. A bounded queue is before it. DecodeThread
// runs the preparation in a thread of its own; a web page has no such thread.
// Thread: each class states its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/net/frame_assembler.hpp"
#include "client/net/relief_cache.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Bounded queue between the network thread and the decode thread. If frames arrive faster than the
/// decode thread processes them, the queue drops the oldest frame. It keeps the coded reliefs of
/// the dropped frame, because later frames may declare them unchanged. Thread: one at a time;
/// DecodeThread locks it.
class FrameQueue {
 public:
  /// Largest number of queued frames. The frame pool has the same number of slots, so the loop
  /// plays all frames that arrive together after a stall of the network.
  static constexpr std::size_t kMaxFrames = FramePool::kSlots;
  /// Limit of the bytes of all queued slices. The stored slices of dropped frames have the same
  /// limit. The value is a choice: a server can use at most 2 x 64 MB of memory here.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// A frame, and the reliefs of the frames that the queue dropped before it.
  struct Accepted {
    AssembledFrame assembled;
    std::vector<CodedObject> left_out;  ///< oldest first
    /// Present: the frame is the first one of another stream with this workspace.
    std::optional<Workspace> begins;
  };

  /// Appends a frame. Returns the number of older frames that the queue dropped for it.
  std::size_t push(AssembledFrame assembled);
  /// Removes and returns the oldest frame; nullopt if the queue is empty.
  [[nodiscard]] std::optional<Accepted> pop();
  /// Drops all frames, but keeps their reliefs.
  void dropAll() {
    while (!frames_.empty()) dropOldest();
  }
  /// Adds `duration` to FramePlace::left of every queued frame. Call it after the decode thread has
  /// deliberately paused for `duration` (FramePreparer::holdsBack()), so that the pause does not
  /// count as preparation time.
  void holdBack(Duration duration);
  [[nodiscard]] bool empty() const { return frames_.empty(); }
  /// Prepares for another stream: removes all frames and all kept reliefs.
  void reset(const Workspace& workspace);

 private:
  void dropOldest();
  void push(CodedObject object);

  std::deque<AssembledFrame> frames_;  // oldest first
  std::size_t bytes_ = 0;              // bytes of the queued reliefs
  std::vector<CodedObject> kept_;      // of dropped frames, one per object and layer
  std::optional<Workspace> begins_;    // of a stream without a popped frame
};

/// Result of the preparation of one frame.
struct PreparedFrame {
  std::uint64_t id = 0;
  FramePlace place;
  LocalTime ready;  ///< time when the frame was published to the loop
  /// False: the decode thread dropped the frame, because the pool had no free slot.
  bool handed_over = false;
  /// Number of objects without a relief, although no loss explains that.
  std::uint64_t reliefs_missing = 0;
  std::uint64_t reliefs_rejected = 0;
  std::uint64_t slices_lost = 0;
  std::uint64_t slices_refused = 0;
  PlayableReliefs playable;
};

/// Distinguishes two causes of a missing relief: the network lost it, or the server never sent it.
/// Thread: one.
class LossWatch {
 public:
  /// Registers the next frame of the stream. `id` is its id. `after_drop` is true if the queue
  /// dropped frames before it.
  void onFrame(const FramePlace& place, std::uint64_t id, bool after_drop);
  /// Returns true if the relief that changed in frame `changed_in_frame` may have been lost.
  [[nodiscard]] bool mayBeLost(std::uint64_t changed_in_frame) const {
    return changed_in_frame < complete_from_;
  }

 private:
  // Every frame from this one on arrived whole. 0: no relief is lost.
  std::uint64_t complete_from_ = 0;
  MediaTime lost_at_;  // of the last loss
};

/// Receives the frames of the Receiver. Thread: network.
class FrameSink {
 public:
  /// Prepares for another stream: drops the queued frames and the cached reliefs.
  virtual void reset(const Workspace& workspace) = 0;
  /// Queues a frame. Returns the number of older frames that the queue dropped for it. Does not
  /// wait for a preparation.
  virtual std::size_t push(AssembledFrame assembled) = 0;

 protected:
  ~FrameSink() = default;
};

/// Prepares frames and fills the frame pool. Thread: one, the decode thread.
class FramePreparer {
 public:
  /// The object publishes frames to `pool`. No other object may do so, because only the decode
  /// thread allocates or frees the data of the slots. After every frame it calls `done`. `method`
  /// selects how heights are prepared. `pool` and `clock` must outlive this object.
  FramePreparer(FramePool& pool, const Clock& clock, Method method,
                std::function<void(const PreparedFrame&)> done);

  /// Memory limit of the prepared reliefs. While the pool has more than kMostPrepared_bytes and at
  /// least kNeededFrames frames, the next frame stays in the queue in coded form. The loop needs
  /// three frames up to play time and two after it. The limit is a choice: three full-HD reliefs.
  static constexpr std::size_t kMostPrepared_bytes = std::size_t{58} << 20U;
  static constexpr std::size_t kNeededFrames = 5;
  /// Returns true if the next frame has to stay in the queue because of that limit.
  [[nodiscard]] bool holdsBack() {
    return pool_.occupied() >= kNeededFrames && pool_.bytes() > kMostPrepared_bytes;
  }
  /// Prepares a frame of the queue and publishes it to the loop.
  void prepare(const FrameQueue::Accepted& accepted);

 private:
  void begin(const FrameQueue::Accepted& accepted);
  void fill(FramePool::Slot& slot, const AssembledFrame& assembled, PreparedFrame& result);
  /// Returns the prepared relief of `object`, and adds its losses to `result`.
  [[nodiscard]] std::shared_ptr<const HeightField> resolve(const CodedObject& object,
                                                           std::uint64_t frame_id,
                                                           PreparedFrame& result);

  FramePool& pool_;
  const Clock& clock_;
  Method method_;
  std::function<void(const PreparedFrame&)> done_;
  ReliefCache reliefs_;
  std::uint32_t epoch_ = 0;  // of the last frame
  LossWatch losses_;
};

}  // namespace hapticast::client
