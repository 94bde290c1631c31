// SPDX-License-Identifier: MIT
#include "client/haptics/flight_recorder.hpp"

#include <algorithm>

namespace hapticast::client {

void FlightRecorder::record(const TickReport& report) noexcept {
  if (frozen()) return;
  reports_[next_] = report;
  next_ = (next_ + 1) % kTicks;
  count_ = std::min(count_ + 1, kTicks);
  if (report.fault != Fault::kNone) frozen_.store(true, std::memory_order_release);
}

void FlightRecorder::rearm() noexcept {
  if (!frozen()) return;
  next_ = count_ = 0;
  frozen_.store(false, std::memory_order_release);
}

}  // namespace hapticast::client
