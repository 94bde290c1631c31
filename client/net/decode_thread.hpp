// SPDX-License-Identifier: MIT
// Second stage of reception: decodes the reliefs of a frame, prepares them as height fields, and
// publishes the frame to the loop. A preparation lasts milliseconds. It has a thread of its own, so
// that the network thread can answer pings and register arrival times meanwhile.
// Thread: each function states its own.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/net/frame_assembler.hpp"
#include "client/net/relief_cache.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Bounded queue between the network thread and the decode thread. If frames arrive faster than
/// they are decoded, the queue drops the oldest frame. It stores the reliefs of a dropped frame,
/// because later frames may declare them unchanged. Thread: one at a time; DecodeThread locks it.
class FrameQueue {
 public:
  /// Largest number of queued frames. The loop can store as many, so the frames that arrive
  /// together after a stall of the network are all played.
  static constexpr std::size_t kMaxFrames = FramePool::kSlots;
  /// Limit of the bytes of all queued slices. The stored slices of dropped frames have the same
  /// limit. The value is a choice: a server can use at most 2 x 64 MB of memory here.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// A frame, and the reliefs of frames that were dropped before it.
  struct Accepted {
    AssembledFrame assembled;
    std::vector<CodedObject> left_out;  ///< oldest first
  };

  /// Appends a frame. Returns the number of older frames that the queue dropped for it.
  std::size_t push(AssembledFrame assembled);
  /// Removes and returns the oldest frame; nullopt if the queue is empty.
  [[nodiscard]] std::optional<Accepted> pop();
  /// Tells the queue that the decode thread deliberately took no frame for `duration`
  /// (DecodeThread::holdsBack()). The queue adds `duration` to FramePlace::left of every queued
  /// frame, so that this time does not count as preparation delay.
  void holdBack(Duration duration);
  [[nodiscard]] bool empty() const { return frames_.empty(); }
  void clear();

 private:
  void dropOldest();
  void push(CodedObject object);

  std::deque<AssembledFrame> frames_;  // oldest first
  std::size_t bytes_ = 0;              // bytes of the queued reliefs
  std::vector<CodedObject> kept_;      // of dropped frames, one per object and layer
};

/// Result of the preparation of one frame.
struct PreparedFrame {
  FramePlace place;
  LocalTime ready;  ///< time when the frame was published to the loop
  /// False: the frame was dropped, because the loop occupied every slot of the pool.
  bool handed_over = false;
  /// Objects without a relief, though no loss explains it.
  std::uint64_t reliefs_missing = 0;
  std::uint64_t reliefs_rejected = 0;
  std::uint64_t slices_lost = 0;
  std::uint64_t slices_refused = 0;
  PlayableReliefs playable;
};

/// Distinguishes a relief that was lost on the way from one that the server never sent. Thread:
/// one.
class LossWatch {
 public:
  /// Registers the next frame of the stream, with the id `id`. `after_drop`: the queue dropped
  /// frames before it.
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

/// The decode thread: it fills the frame pool.
class DecodeThread {
 public:
  /// Publishes frames to `pool`. Only this object may do so, because only its thread allocates or
  /// frees the data of the slots. It calls `done` after every frame, in the thread of step().
  /// `method` selects how heights are prepared. `pool` and `clock` must outlive this object.
  DecodeThread(FramePool& pool, const Clock& clock, Method method,
               std::function<void(const PreparedFrame&)> done);
  DecodeThread(const DecodeThread&) = delete;
  DecodeThread& operator=(const DecodeThread&) = delete;
  ~DecodeThread() { stop(); }

  /// Starts a thread that calls step() for each queued frame. Thread: the owner's.
  void start();
  /// Ends the thread after its current frame. The queued frames are not processed. A second call
  /// does nothing. Thread: that of start().
  void stop();

  /// Prepares for another stream: drops the queued frames and the cached reliefs. Thread: network.
  void reset(const Workspace& workspace);
  /// Queues a frame. Returns the number of older frames that the queue dropped for it. Does not
  /// wait for a preparation. Thread: network.
  std::size_t push(AssembledFrame assembled);

  /// Limits of the prepared reliefs: while the pool has more bytes and at least so many frames, a
  /// further frame waits in coded form. The loop needs three frames up to play time and two after
  /// it. The number of bytes is a choice: three full-HD reliefs.
  static constexpr std::size_t kMostPrepared_bytes = std::size_t{58} << 20U;
  static constexpr std::size_t kNeededFrames = 5;
  /// Returns true if the next frame has to wait for that reason. Thread: the decode thread.
  [[nodiscard]] bool holdsBack() {
    return pool_.occupied() >= kNeededFrames && pool_.bytes() > kMostPrepared_bytes;
  }
  /// Prepares the oldest queued frame and publishes it to the loop. Returns false if the queue is
  /// empty. Thread: the decode thread. Before start() a test may call it.
  bool step();

 private:
  void run(const std::stop_token& stop);
  /// Waits a moment for the loop to return a slot.
  void waitForSlot();
  /// Removes and returns the oldest frame. Updates the relief cache with the dropped frames before
  /// it.
  [[nodiscard]] std::optional<AssembledFrame> next();
  void fill(FramePool::Slot& slot, const AssembledFrame& assembled, PreparedFrame& result);
  void fillObject(FramePool::Slot& slot, std::size_t index, const CodedObject& object,
                  std::uint64_t frame_id, PreparedFrame& result);

  FramePool& pool_;
  const Clock& clock_;
  Method method_;
  std::function<void(const PreparedFrame&)> done_;
  ReliefCache reliefs_;      // thread of step() only
  std::uint32_t epoch_ = 0;  // thread of step() only; epoch of the last frame
  LossWatch losses_;         // thread of step() only

  std::mutex mutex_;
  std::condition_variable_any something_waits_;
  FrameQueue queue_;  // guarded by mutex_
  // Guarded by mutex_; workspace of a stream that step() has not begun.
  std::optional<Workspace> begins_;
  std::jthread thread_;  // last member: the thread uses all members above
};

}  // namespace hapticast::client
