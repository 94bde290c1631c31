// SPDX-License-Identifier: MIT
// The clock of tests that wait for real sockets: time goes on only while they run. What a busy
// machine takes away between two turns does not count, so no deadline passes unseen by whoever
// keeps it. Thread: any.
#pragma once

#include <algorithm>
#include <mutex>

#include "common/time.hpp"

namespace hapticast::testing {

class PatientClock final : public Clock {
 public:
  /// Of real time so much counts until the next turn, and no more.
  static constexpr Duration kMostInATurn = std::chrono::milliseconds(5);

  [[nodiscard]] LocalTime now() const noexcept override {
    const std::scoped_lock lock(mutex_);
    return passed();
  }
  /// The test looks at everything once more.
  void turn() noexcept {
    const std::scoped_lock lock(mutex_);
    turned_ = passed();
    turned_really_ = real_.now();
  }

 private:
  [[nodiscard]] LocalTime passed() const noexcept {
    return turned_ + std::min(real_.now() - turned_really_, kMostInATurn);
  }

  SteadyClock real_;
  mutable std::mutex mutex_;
  LocalTime turned_ = real_.now();
  LocalTime turned_really_ = turned_;
};

}  // namespace hapticast::testing
