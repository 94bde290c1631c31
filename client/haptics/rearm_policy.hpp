// SPDX-License-Identifier: MIT
// --rearm: when the force may come back by itself. Thread: main.
#pragma once

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

class RearmPolicy {
 public:
  /// Chosen: so long after trust was lost it is forgiven, ...
  static constexpr Duration kDelay = std::chrono::seconds(5);
  /// ... and so often only.
  static constexpr int kMaxCount = 3;

  /// Without `by_itself` it never is; `by_key`: somebody can do it in a window.
  explicit RearmPolicy(bool by_itself, bool by_key = false)
      : by_itself_(by_itself), by_key_(by_key) {}

  /// Sees every report; whether the force is to be re-armed now.
  [[nodiscard]] bool onReport(const TickReport& report);
  /// Whether a lost device's force returns, as often as the device does.
  [[nodiscard]] bool automatic() const { return by_itself_; }
  /// Whether a key of the window brings the force back.
  [[nodiscard]] bool manual() const { return by_key_; }
  /// How often lost trust will still be forgiven.
  [[nodiscard]] int left() const { return by_itself_ ? kMaxCount - forgiven_ : 0; }

 private:
  bool by_itself_;
  bool by_key_;
  int forgiven_ = 0;
  bool requested_ = false;  // the loop has not answered yet
  Halt halt_ = Halt::kNone;
  LocalTime halted_{};  // since then
};

}  // namespace hapticast::client
