// SPDX-License-Identifier: MIT
// Flight recorder: a ring buffer of the last 2000 tick reports. The first fault freezes the buffer
// until a reader outside the loop has read it and re-arms the recorder.
// Threads: loop (record), one reader (everything else).
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// Ring buffer of tick reports with a freeze on the first fault.
class FlightRecorder {
 public:
  /// Length of the recording: 2 s.
  static constexpr std::size_t kTicks = 2000;

  /// Stores the report; a report with a fault freezes the recorder. A frozen recorder ignores it.
  /// Thread: loop.
  void record(const TickReport& report) noexcept;

  /// Returns true after a fault. Then one reader thread may call size() and at(). Thread: any.
  [[nodiscard]] bool frozen() const noexcept { return frozen_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  /// Returns report `index`: 0 is the oldest, size() - 1 the report with the fault. Requires
  /// frozen() and index < size().
  [[nodiscard]] const TickReport& at(std::size_t index) const noexcept {
    return reports_[(next_ + kTicks - count_ + index) % kTicks];
  }
  /// Empties a frozen recorder and enables it again. Thread: the reader.
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
