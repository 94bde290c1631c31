// SPDX-License-Identifier: MIT
// The thread of the 1 kHz loop. It owns its stop: however its owner's scope is left, the force
// ramps to zero and the thread has ended.
#pragma once

#include <atomic>
#include <thread>

#include "client/haptics/loop.hpp"
#include "client/haptics/realtime_thread.hpp"

namespace hapticast::client {

class LoopThread {
 public:
  /// Starts the loop (runLoop) on a thread that has asked for real time and flushes denormals. All
  /// arguments outlive it. Throws std::system_error when no thread can be had.
  LoopThread(HapticDevice& device, HapticRenderer& renderer, const Clock& clock);
  ~LoopThread() { stop(); }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  /// Ramps the force to zero and waits until the loop has ended; again: does nothing. Thread: the
  /// owner's.
  void stop() noexcept;

  // After stop(), the owner's thread:
  [[nodiscard]] const LoopStats& stats() const noexcept { return stats_; }
  [[nodiscard]] const RealtimeGrant& realtime() const noexcept { return realtime_; }

 private:
  std::atomic<bool> stop_{false};
  LoopStats stats_;
  RealtimeGrant realtime_;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace hapticast::client
