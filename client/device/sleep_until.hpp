// SPDX-License-Identifier: MIT
// Sleep until a time of the local clock (CLOCK_MONOTONIC).
// Thread: any.
#pragma once

#include <cerrno>
#include <ctime>

#include "common/time.hpp"

namespace hapticast::client {

/// Returns `time` in the form that the system's functions need.
inline timespec toTimespec(LocalTime time) noexcept {
  const auto since_ns = time.time_since_epoch().count();
  timespec result{};
  result.tv_sec = static_cast<time_t>(since_ns / 1'000'000'000);
  result.tv_nsec = static_cast<decltype(result.tv_nsec)>(since_ns % 1'000'000'000);
  return result;
}

/// Sleeps until `time`. If a signal interrupts the sleep, the sleep continues.
inline void sleepUntil(LocalTime time) noexcept {
  const timespec until = toTimespec(time);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace hapticast::client
