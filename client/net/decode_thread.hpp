// SPDX-License-Identifier: MIT
// Second stage of reception: decodes reliefs, prepares them as height fields and publishes the
// frames to the loop. A preparation lasts milliseconds. It has a thread of its own, so that the
// network thread answers pings and stamps arrivals meanwhile.
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

// Bounded queue between the network thread and the decode thread. If frames arrive faster than the
// decoding, the newest ones win: the queue drops the oldest frame but stores its reliefs. Later
// frames may declare those reliefs unchanged.
// Thread: one at a time; DecodeThread locks it.

class FrameQueue {
 public:
  /// As many as the loop can hold, so that the burst after a stall of the network is played.
  static constexpr std::size_t kMaxFrames = FramePool::kSlots;
  /// Limit of the bytes of all queued slices, and of all stored slices. Chosen: a server occupies
  /// at most 2 x 64 MB here.
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

  /// A frame, and the reliefs of the frames that were dropped before it.
  struct Accepted {
    AssembledFrame assembled;
    std::vector<CodedObject> left_out;  ///< oldest first
  };

  /// Appends a frame. Returns the number of older frames that were dropped for it.
  std::size_t push(AssembledFrame assembled);
  /// Removes and returns the oldest frame; nullopt if the queue is empty.
  [[nodiscard]] std::optional<Accepted> pop();
  [[nodiscard]] bool empty() const { return frames_.empty(); }
  void clear();

 private:
  void dropOldest();
  void push(CodedObject object);

  std::deque<AssembledFrame> frames_;  // oldest first
  std::size_t bytes_ = 0;              // bytes of the queued reliefs
  std::vector<CodedObject> kept_;      // of dropped frames, one per object and layer
};

/// Result of a frame.
struct PreparedFrame {
  FramePlace place;
  LocalTime ready;           ///< time of the publication
  bool handed_over = false;  ///< false: the loop held every slot of the pool
  std::uint64_t reliefs_missing = 0;
  std::uint64_t reliefs_rejected = 0;
  std::uint64_t slices_lost = 0;
  std::uint64_t slices_refused = 0;
  PlayableReliefs playable;
};

/// Producer of the frame pool.
class DecodeThread {
 public:
  /// This object must be the only producer of `pool`: only its thread allocates or frees the data
  /// of the slots. It calls `done` for every frame, in the thread of step(). `pool` and `clock`
  /// must outlive this object. `method` selects the preparation of heights.
  DecodeThread(FramePool& pool, const Clock& clock, Method method,
               std::function<void(const PreparedFrame&)> done);
  DecodeThread(const DecodeThread&) = delete;
  DecodeThread& operator=(const DecodeThread&) = delete;
  ~DecodeThread() { stop(); }

  /// Starts a thread that calls step() for each queued frame. Thread: the owner's.
  void start();
  /// Ends the thread after the current frame; queued frames remain. A second call does nothing.
  /// Thread: that of start().
  void stop();

  /// Starts another stream: queued frames are void, and the cached reliefs are dropped. Thread:
  /// network.
  void reset(const Workspace& workspace);
  /// Queues a frame. Returns the number of older frames that were dropped for it. Does not wait for
  /// a preparation. Thread: network.
  std::size_t push(AssembledFrame assembled);

  /// Prepares the oldest queued frame and publishes it to the loop. Returns false if the queue is
  /// empty. Thread: the decode thread; before start() the caller's (tests).
  bool step();

 private:
  void run(const std::stop_token& stop);
  /// Fetches the oldest frame, and updates the relief cache up to the frame before it.
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

  std::mutex mutex_;
  std::condition_variable_any something_waits_;
  FrameQueue queue_;  // guarded by mutex_
  // Guarded by mutex_; workspace of a stream that step() has not begun.
  std::optional<Workspace> begins_;
  std::jthread thread_;  // last member: the thread uses all members above
};

}  // namespace hapticast::client
