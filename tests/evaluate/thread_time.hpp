// SPDX-License-Identifier: MIT
// What a stage costs: time of this thread's own work, whatever else the machine does.
#pragma once

#include <ctime>

namespace hapticast::evaluate {

inline double threadTime_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * double(now.tv_sec) + 1e-3 * double(now.tv_nsec);
}

}  // namespace hapticast::evaluate
