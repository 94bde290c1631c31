// SPDX-License-Identifier: MIT
#include "client/haptics/rearm_policy.hpp"

namespace hapticast::client {

bool RearmPolicy::take(const TickReport& report) {
  if (report.halt != halt_) {
    halt_ = report.halt;
    halted_ = report.time;
  }
  const bool waits = deviceIsBack(report) || report.halt == Halt::kUnconfirmed ||
                     (halt_ == Halt::kTrustLost && report.device == DeviceStatus::kOk);
  if (!waits) asked_ = false;  // a device that is lost again has not heard of it
  if (!by_itself_ || !waits || asked_) return false;
  if (halt_ == Halt::kTrustLost) {
    if (forgiven_ == kMaxCount || report.time - halted_ < kLater) return false;
    ++forgiven_;
  }
  asked_ = true;
  return true;
}

}  // namespace hapticast::client
