// SPDX-License-Identifier: MIT
// The 1 kHz haptic loop around the renderer, and its statistics for the summary.
// Thread: the loop's own thread.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>

#include "client/device/loop/realtime_thread.hpp"
#include "client/haptics/renderer.hpp"
#include "common/histogram.hpp"

namespace hapticast::client {

/// Statistics of a run. Thread: loop; any thread after runLoop() has returned.
struct LoopStats {
  std::uint64_t ticks = 0;
  /// Number of ticks that began more than 1.5 ms after the tick before.
  std::uint64_t late_ticks = 0;
  Histogram tick_ns;      ///< time that the renderer needed for each tick
  Histogram exchange_ns;  ///< time that HapticDevice::exchange() needed in each tick
  std::array<std::uint64_t, kLookupKinds> lookup{};
  /// Number of ticks in contact for each Lookup. `lookup` counts all ticks.
  std::array<std::uint64_t, kLookupKinds> contact_lookup{};
  std::array<std::uint64_t, kSafetyActionNames.size()> safety_actions{};
  /// Number of faults of each kind; the index is a Fault.
  std::array<std::uint64_t, kFaultKinds> faults{};
  std::uint64_t contact_ticks = 0;
  /// Largest magnitude of the force, and largest change of the force from one tick to the next.
  double max_force_N = 0.0;
  double max_force_step_N = 0.0;
  /// Largest step of the force beyond the steps that the motion of the HIP and the slew limit
  /// allow, N. It must be 0.
  double step_excess_max_N = 0.0;
  std::uint32_t safety_states = 0;  ///< bits of all safety states that the run had
  PortWork work;                    ///< work of the force since the start, by its cause

  /// Adds one tick to the statistics. `step_N` is the magnitude of the change of the force since
  /// the tick before, N.
  void add(const TickReport& report, double step_N) noexcept;
};

/// Runs the haptic loop until `stop` is true. It then ramps the force to zero, and sends the device
/// a last force of zero.
///
/// Each tick has a deadline for its begin, on a grid of 1 ms. After a stall the loop skips the
/// missed deadlines, without a burst of ticks. If a device ends the wait early, the grid moves: the
/// next deadline is one period after the begin of that tick. So a tick begins in time even if the
/// device no longer replies. All arguments must outlive the call. Thread: the loop's own.
void runLoop(HapticDevice& device, HapticRenderer& renderer, const Clock& clock,
             const std::atomic<bool>& stop, LoopStats& stats) noexcept;

/// Runs the haptic loop in a thread of its own. The destructor ramps the force to zero and joins
/// the thread, also when an exception unwinds the owner's scope. Thread: the owner's, for all
/// public functions.
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
