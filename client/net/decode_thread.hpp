// SPDX-License-Identifier: MIT
// Second stage of reception: a thread that prepares frames for the loop (frame_preparer.hpp). The
// preparation of a frame lasts milliseconds. A separate thread does it, so that the network thread
// can process pings and record arrival times meanwhile.
// Thread: each function states its own.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <thread>

#include "client/net/frame_preparer.hpp"

namespace hapticast::client {

/// Runs the decode thread, which fills the frame pool: it prepares the oldest queued frame and
/// publishes it to the loop.
class DecodeThread final : public FrameSink {
 public:
  /// The arguments are those of FramePreparer. The object calls `done` in its thread.
  DecodeThread(FramePool& pool, const Clock& clock, Method method,
               std::function<void(const PreparedFrame&)> done)
      : clock_(clock), preparer_(pool, clock, method, std::move(done)) {}
  DecodeThread(const DecodeThread&) = delete;
  DecodeThread& operator=(const DecodeThread&) = delete;
  ~DecodeThread() { stop(); }

  /// Starts the thread. Thread: the owner's.
  void start();
  /// Ends the thread after its current frame. The queued frames are not processed. A second call
  /// does nothing. Thread: that of start().
  void stop();

  void reset(const Workspace& workspace) override;
  std::size_t push(AssembledFrame assembled) override;

 private:
  void run(const std::stop_token& stop);
  /// Sleeps for 2 ms, in which the loop may return a slot.
  void waitForSlot();

  const Clock& clock_;
  FramePreparer preparer_;  // decode thread only

  std::mutex mutex_;
  std::condition_variable_any something_waits_;
  FrameQueue queue_;     // guarded by mutex_
  std::jthread thread_;  // last member: the thread uses all members above
};

}  // namespace hapticast::client
