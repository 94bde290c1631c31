// SPDX-License-Identifier: MIT
// Flight recorder: a ring buffer of the last 2000 tick reports. The first fault freezes the buffer,
// so that the ticks before the fault are preserved. A reader outside the loop then reads it and
// calls rearm(), which starts the recording again.
// Threads: loop (record), one reader (everything else).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// Ring buffer of tick reports. A report with a fault freezes it.
class FlightRecorder {
 public:
  /// Number of ticks in the recording: 2 s.
  static constexpr std::size_t kTicks = 2000;

  /// Stores `report`. If the report has a fault, the recorder freezes after it. A frozen recorder
  /// ignores the call. Thread: loop.
  void record(const TickReport& report) noexcept;

  /// Returns true from a fault until rearm(). While it is true, one reader thread may call size()
  /// and at(). At other times no thread may call them. Thread: any.
  [[nodiscard]] bool frozen() const noexcept { return frozen_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  /// Returns the report with the index `index`. Index 0 is the oldest report, and size() - 1 is the
  /// report with the fault. Requires frozen() and index < size().
  [[nodiscard]] const TickReport& at(std::size_t index) const noexcept {
    return reports_[(next_ + kTicks - count_ + index) % kTicks];
  }
  /// Empties a frozen recorder and starts the recording again. Thread: the reader.
  void rearm() noexcept;

 private:
  std::array<TickReport, kTicks> reports_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  // True: the reader owns the members above. False: the loop owns them. Store with release, load
  // with acquire.
  std::atomic<bool> frozen_{false};
};

}  // namespace hapticast::client
