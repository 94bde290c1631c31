// SPDX-License-Identifier: MIT
// --rearm: when the force may come back by itself. Thread: main.
#pragma once

#include <optional>

#include "client/haptics/tick_report.hpp"

namespace hapticast::client {

class Rearm {
 public:
  /// Chosen: after lost trust nothing has to be held back for so long, ...
  static constexpr Duration kCalm = std::chrono::seconds(5);
  /// ... and so often only.
  static constexpr int kTimes = 3;

  /// Without `by_itself` it never is.
  explicit Rearm(bool by_itself) : by_itself_(by_itself) {}

  /// Sees every report; whether the force is to be re-armed now.
  [[nodiscard]] bool take(const TickReport& report);
  /// How often lost trust will still be forgiven.
  [[nodiscard]] int left() const { return by_itself_ ? kTimes - forgiven_ : 0; }

 private:
  bool by_itself_;
  int forgiven_ = 0;
  bool asked_ = false;  // the loop has not answered yet
  LocalTime disturbed_{};
};

}  // namespace hapticast::client
