// SPDX-License-Identifier: MIT
// The last 2000 ticks, frozen at the first fault until somebody outside the loop has read them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

class FlightRecorder {
 public:
  static constexpr std::size_t kTicks = 2000;

  /// Keeps the report; one with a fault freezes the recorder. Frozen: does nothing. Thread: loop.
  void record(const TickReport& report) noexcept;

  /// Thread: any. When true, size() and at() may be called by the one thread that reads recordings.
  [[nodiscard]] bool frozen() const noexcept { return frozen_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  /// Report `index`, 0 the oldest, size() - 1 the one with the fault.
  [[nodiscard]] const TickReport& at(std::size_t index) const noexcept {
    return reports_[(next_ + kTicks - count_ + index) % kTicks];
  }
  /// Empties a frozen recorder and lets it record again. Thread: the one that reads recordings.
  void rearm() noexcept;

 private:
  std::array<TickReport, kTicks> reports_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
  // True: everything above belongs to the reader; false: to the loop. Release hands over, acquire
  // takes.
  std::atomic<bool> frozen_{false};
};

}  // namespace hapticast::client
