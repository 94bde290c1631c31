// SPDX-License-Identifier: MIT
// The 1 kHz haptic loop around the renderer, and its statistics for the summary.
// Thread: the loop's own thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "client/haptics/realtime_thread.hpp"
#include "client/haptics/renderer.hpp"
#include "common/histogram.hpp"

namespace hapticast::client {

/// Statistics of a run. Thread: loop; any thread after runLoop() has returned.
struct LoopStats {
  std::uint64_t ticks = 0;
  std::uint64_t late_ticks = 0;  ///< began more than 1.5 ms after the tick before
  Histogram tick_ns;             ///< time in the renderer
  Histogram exchange_ns;         ///< time in the device
  std::array<std::uint64_t, kLookupKinds> lookup{};
  std::array<std::uint64_t, kLookupKinds> contact_lookup{};  ///< ticks in contact only
  std::array<std::uint64_t, kInterferenceNames.size()> interferences{};
  std::array<std::uint64_t, kFaultKinds> faults{};  ///< index: Fault
  std::uint64_t contact_ticks = 0;
  /// Largest |force|, largest |change| of the force in a tick.
  double max_force_N = 0.0;
  double max_force_step_N = 0.0;
  /// Largest excess over the slew limit; must be 0.
  double step_excess_max_N = 0.0;
  PortWork work;  ///< work of the force at its ports

  /// Counts one tick. `step_N` is the |change| of the force, N.
  void add(const TickReport& report, double step_N) noexcept;
};

/// Runs ticks until `stop`, then ramps the force to zero and leaves the device at zero.
///
/// Deadlines lie on a grid of 1 ms. The loop skips the deadlines that a stall has missed, without a
/// burst of ticks. A device with an early reply moves the grid: the next deadline is at most one
/// period away. So the deadline remains a watchdog. All arguments must outlive the call. Thread:
/// the loop's own.
void runLoop(HapticDevice& device, HapticRenderer& renderer, const Clock& clock,
             const std::atomic<bool>& stop, LoopStats& stats) noexcept;

// The thread of the 1 kHz loop (RAII). The destructor ramps the force to zero and joins the thread,
// also when an exception unwinds the owner's scope.
// Thread: the owner's, for all public functions.

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
