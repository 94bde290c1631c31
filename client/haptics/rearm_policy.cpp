// SPDX-License-Identifier: MIT
#include "client/haptics/rearm_policy.hpp"

namespace hapticast::client {

bool RearmPolicy::onReport(const TickReport& report) {
  if (report.halt != halt_) {
    halt_ = report.halt;
    halted_ = report.time;
  }
  const bool waits = deviceIsBack(report) || report.halt == Halt::kUnconfirmed ||
                     (halt_ == Halt::kTrustLost && report.device == DeviceStatus::kOk);
  if (!waits) requested_ = false;  // a device lost again did not receive the request
  if (!by_itself_ || !waits || requested_) return false;
  if (halt_ == Halt::kTrustLost) {
    if (forgiven_ == kMaxCount || report.time - halted_ < kDelay) return false;
    ++forgiven_;
  }
  requested_ = true;
  return true;
}

}  // namespace hapticast::client
