// SPDX-License-Identifier: MIT
// How tests wait: for an event, by one loop (tests/README.md, "Waiting and ports"). Thread: any.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace hapticast {

/// Asks `done` every 20 ms until it says yes; false when it has not by the deadline. A deadline
/// only ends a test that has failed: it is at least ten times what an idle machine needs.
inline bool waitUntil(std::chrono::seconds deadline, const std::function<bool()>& done) {
  const auto give_up = std::chrono::steady_clock::now() + deadline;
  while (!done()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

/// What stands in for hardware or another machine rests between two turns. A test never waits by
/// it: check.waiting has the list of those who may rest.
inline void restBetweenTurns(std::chrono::milliseconds time = std::chrono::milliseconds(2)) {
  std::this_thread::sleep_for(time);
}

}  // namespace hapticast
