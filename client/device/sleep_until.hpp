// SPDX-License-Identifier: MIT
// Waiting for a time of the local clock, which is the system's monotonic one. Thread: any.
#pragma once

#include <cerrno>
#include <ctime>

#include "common/time.hpp"

namespace hapticast::client {

/// As the system's calls want it.
inline timespec toTimespec(LocalTime time) noexcept {
  const auto since_ns = time.time_since_epoch().count();
  return {static_cast<time_t>(since_ns / 1'000'000'000), since_ns % 1'000'000'000};
}

/// Interrupted by a signal it sleeps on until the same absolute time.
inline void sleepUntil(LocalTime time) noexcept {
  const timespec until = toTimespec(time);
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace hapticast::client
