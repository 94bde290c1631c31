// SPDX-License-Identifier: MIT
// The second step of receiving: prepares reliefs for touch, which takes milliseconds, and hands the
// frames to the loop. It has a thread of its own, so that the network's thread answers and stamps
// what comes in the meantime.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "client/haptics/playback/frame_pool.hpp"
#include "client/haptics/playback/playable_reliefs.hpp"
#include "client/net/frame_assembler.hpp"
#include "client/net/frame_queue.hpp"
#include "client/net/relief_cache.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// What became of a frame.
struct PreparedFrame {
  FramePlace place;
  LocalTime ready;           ///< when the loop could have it
  bool handed_over = false;  ///< false: the loop held every slot of the pool
  std::uint64_t reliefs_missing = 0;
  std::uint64_t reliefs_rejected = 0;
  std::uint64_t slices_lost = 0;
  std::uint64_t slices_refused = 0;
  PlayableReliefs playable;
};

class DecodeThread {
 public:
  /// The preparer is the one producer of `pool`: only its thread allocates or frees what the slots
  /// point to. `done` is told of every frame, on the thread of step(). `pool` and `clock` outlive
  /// the preparer; `method` chooses how heights are prepared.
  DecodeThread(FramePool& pool, const Clock& clock, Method method,
               std::function<void(const PreparedFrame&)> done);
  DecodeThread(const DecodeThread&) = delete;
  DecodeThread& operator=(const DecodeThread&) = delete;
  ~DecodeThread() { stop(); }

  /// Begins to call step() on a thread of its own whenever a frame waits.
  void start();
  /// Ends the thread once the frame that is being prepared is done; the ones that wait stay.
  /// Thread: the one of start().
  void stop();

  /// What is pushed from now on belongs to another stream: frames that wait are void, and reliefs
  /// of before are forgotten. Thread: network.
  void reset(const Workspace& workspace);
  /// Appends a frame and returns how many older ones were left out for it. Never waits for a
  /// preparation. Thread: network.
  std::size_t push(AssembledFrame assembled);

  /// Prepares the oldest frame that waits and hands it to the loop; false when none waits. Thread:
  /// the preparer's; before start() the caller's, which is how tests drive it.
  bool step();

 private:
  void run(const std::stop_token& stop);
  /// Takes the oldest frame and brings the reliefs up to the moment before it.
  [[nodiscard]] std::optional<AssembledFrame> next();
  void fill(FramePool::Slot& slot, const AssembledFrame& assembled, PreparedFrame& result);
  void fillObject(FramePool::Slot& slot, std::size_t index, const CodedObject& object,
                  std::uint64_t frame_id, PreparedFrame& result);

  FramePool& pool_;
  const Clock& clock_;
  Method method_;
  std::function<void(const PreparedFrame&)> done_;
  ReliefCache reliefs_;      // thread of step() only
  std::uint32_t epoch_ = 0;  // the same: of the last frame

  std::mutex mutex_;
  std::condition_variable_any something_waits_;
  FrameQueue queue_;                 // guarded by mutex_
  std::optional<Workspace> begins_;  // guarded by mutex_; a stream that step() has not begun yet
  std::jthread thread_;              // last: it uses everything above
};

}  // namespace hapticast::client
