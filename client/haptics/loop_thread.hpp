// SPDX-License-Identifier: MIT
// The thread of the 1 kHz loop (RAII). The destructor ramps the force to zero and joins the thread,
// also when an exception unwinds the owner's scope.
// Thread: the owner's, for all public functions.
#pragma once

#include <atomic>
#include <thread>

#include "client/haptics/loop.hpp"
#include "client/haptics/realtime_thread.hpp"

namespace hapticast::client {

/// Runs the haptic loop in a thread of its own.
class LoopThread {
 public:
  /// Starts runLoop() in a thread that requests real-time scheduling and flushes denormals. All
  /// arguments must outlive this object. Throws std::system_error if the thread cannot start.
  LoopThread(HapticDevice& device, HapticRenderer& renderer, const Clock& clock);
  ~LoopThread() { stop(); }
  LoopThread(const LoopThread&) = delete;
  LoopThread& operator=(const LoopThread&) = delete;

  /// Ramps the force to zero and joins the thread. A second call does nothing. Thread: the owner's.
  void stop() noexcept;

  // After stop(), in the owner's thread:
  [[nodiscard]] const LoopStats& stats() const noexcept { return stats_; }
  [[nodiscard]] const RealtimeGrant& realtime() const noexcept { return realtime_; }

 private:
  std::atomic<bool> stop_{false};
  LoopStats stats_;
  RealtimeGrant realtime_;
  std::thread thread_;  // last member: the thread uses all members above
};

}  // namespace hapticast::client
