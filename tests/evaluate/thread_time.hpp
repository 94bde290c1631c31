// SPDX-License-Identifier: MIT
// Cost of a stage: computing time of this thread.
#pragma once

#include <ctime>

#include "common/time.hpp"

namespace hapticast::evaluate {

inline double threadTime_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * double(now.tv_sec) + 1e-3 * double(now.tv_nsec);
}

/// The same as a clock.
class ThreadClock final : public Clock {
 public:
  [[nodiscard]] LocalTime now() const noexcept override {
    return localTime(1e-6 * threadTime_us());
  }
};

}  // namespace hapticast::evaluate
