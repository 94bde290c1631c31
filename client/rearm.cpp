// SPDX-License-Identifier: MIT
#include "client/rearm.hpp"

#include "client/haptics/safety/trust.hpp"

namespace hapticast::client {

bool Rearm::take(const TickReport& report) {
  const bool waits = report.halt == Halt::kDeviceLost || report.halt == Halt::kTrustLost;
  if (!waits) asked_ = false;
  for (const Interference each : Trust::kCounted) {
    if ((report.interferences & bit(each)) != 0) disturbed_ = report.time;
  }
  if (!by_itself_ || !waits || asked_ || report.device != DeviceStatus::kOk) return false;
  if (report.halt == Halt::kTrustLost) {
    if (forgiven_ == kTimes || report.time - disturbed_ < kCalm) return false;
    ++forgiven_;
  }
  asked_ = true;
  return true;
}

}  // namespace hapticast::client
