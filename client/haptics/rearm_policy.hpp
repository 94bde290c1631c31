// SPDX-License-Identifier: MIT
// Policy of automatic re-arming (--rearm). Re-arming ends a halt, so that the force can return. The
// policy decides when the client re-arms by itself.
// Thread: main.
#pragma once

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// Decides when to re-arm a halted force. It needs every tick report, in order.
class RearmPolicy {
 public:
  /// Time from a loss of trust to the automatic re-arming. The value is a choice.
  static constexpr Duration kDelay = std::chrono::seconds(5);
  /// Largest number of automatic re-armings after a loss of trust, per run. The value is a choice.
  static constexpr int kMaxCount = 3;

  /// If `by_itself` is true, the client re-arms automatically. If `by_key` is true, the user can
  /// re-arm with a key of the window.
  explicit RearmPolicy(bool by_itself, bool by_key = false)
      : by_itself_(by_itself), by_key_(by_key) {}

  /// Processes one report. Returns true if the caller has to re-arm the force now. Without
  /// automatic re-arming it always returns false.
  [[nodiscard]] bool onReport(const TickReport& report);
  /// Returns true if the client re-arms automatically. After the return of a device, the number of
  /// automatic re-armings has no limit.
  [[nodiscard]] bool automatic() const { return by_itself_; }
  /// Returns true if the user can re-arm with a key of the window.
  [[nodiscard]] bool manual() const { return by_key_; }
  /// Returns the number of remaining automatic re-armings after a loss of trust.
  [[nodiscard]] int left() const { return by_itself_ ? kMaxCount - forgiven_ : 0; }

 private:
  bool by_itself_;
  bool by_key_;
  int forgiven_ = 0;
  bool requested_ = false;  // re-armed, and the loop still reports the halt
  Halt halt_ = Halt::kNone;
  LocalTime halted_{};  // begin of the halt
};

inline bool RearmPolicy::onReport(const TickReport& report) {
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
