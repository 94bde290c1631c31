// SPDX-License-Identifier: MIT
// The 1 kHz loop around the room, and what it counts for the summary.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "client/haptics/renderer.hpp"
#include "common/histogram.hpp"

namespace hapticast::client {

/// Everything of the summary that the loop knows. Thread: the loop's; read it after runLoop() has
/// returned.
struct LoopStats {
  std::uint64_t ticks = 0;
  std::uint64_t late_ticks = 0;  ///< began more than 1.5 ms after the one before
  Histogram tick_ns;             ///< time in the room
  Histogram exchange_ns;         ///< time in the device
  std::array<std::uint64_t, kLookupKinds> lookup{};
  std::array<std::uint64_t, kLookupKinds> contact_lookup{};  ///< of the ticks in contact
  std::array<std::uint64_t, kInterferenceNames.size()> interferences{};
  std::array<std::uint64_t, kFaultKinds> faults{};  ///< index: Fault
  std::uint64_t contact_ticks = 0;
  double max_force_N = 0.0;
  double max_force_step_N = 0.0;
  double step_excess_max_N = 0.0;
  PortWork work;  ///< of the force so far

  /// Counts one tick. `step_N`: |change| of the force.
  void add(const TickReport& report, double step_N) noexcept;
};

/// Runs until `stop`, then ramps the force to zero and leaves the device at zero. Where a timer
/// wakes the loop the deadlines lie on a grid of one millisecond, and those missed in a stall are
/// skipped, not caught up. A device that wakes it earlier by its reply moves the grid along: the
/// deadline is never more than a period away, so it stays a watchdog. Thread: the loop's.
void runLoop(HapticDevice& device, HapticRenderer& renderer, const Clock& clock,
             const std::atomic<bool>& stop, LoopStats& stats) noexcept;

}  // namespace hapticast::client
