// SPDX-License-Identifier: MIT
// The clock of every test that lives in virtual time: it stands until it is moved.
#pragma once

#include "common/time.hpp"

namespace hapticast {

class ManualClock final : public Clock {
 public:
  explicit ManualClock(LocalTime begin = localTime(1.0)) noexcept : now_(begin) {}
  [[nodiscard]] LocalTime now() const noexcept override { return now_; }
  void advance(Duration by) noexcept { now_ += by; }
  void set(LocalTime now) noexcept { now_ = now; }

 private:
  LocalTime now_;
};

}  // namespace hapticast
