// SPDX-License-Identifier: MIT
// Policy of automatic re-arming (--rearm): decides when a halted force may return.
// Thread: main.
#pragma once

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

/// Decides on the re-arming of a halted force. Reads every tick report in order.
class RearmPolicy {
 public:
  /// Wait between the loss of trust and its automatic re-arming. Chosen.
  static constexpr Duration kDelay = std::chrono::seconds(5);
  /// Number of automatic re-armings after a loss of trust. Chosen.
  static constexpr int kMaxCount = 3;

  /// `by_itself`: automatic re-arming is on. `by_key`: the user can re-arm with a key of the
  /// window.
  explicit RearmPolicy(bool by_itself, bool by_key = false)
      : by_itself_(by_itself), by_key_(by_key) {}

  /// Processes a report. Returns true if the caller has to re-arm the force now.
  [[nodiscard]] bool onReport(const TickReport& report);
  /// Returns true if re-arming is automatic. For a returned device it has no count limit.
  [[nodiscard]] bool automatic() const { return by_itself_; }
  /// Returns true if a key of the window re-arms.
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
