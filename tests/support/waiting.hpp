// SPDX-License-Identifier: MIT
// How tests wait: for an event, by one loop (tests/README.md, "Waiting and ports"). Thread: any.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

namespace hapticast {

/// Asks `done` until it says yes, first every 10 ms, later every twentieth part of the time that
/// has passed, every 100 ms at the most: a question may cost as much as the program that a test
/// waits for. Returns false when it has not by the deadline. A deadline only ends a test that has
/// failed: it is at least ten times what an idle machine needs.
inline bool waitUntil(std::chrono::seconds deadline, const std::function<bool()>& done) {
  using std::chrono::milliseconds;
  const auto begin = std::chrono::steady_clock::now();
  while (!done()) {
    const auto passed = std::chrono::steady_clock::now() - begin;
    if (passed > deadline) return false;
    const auto pause = std::chrono::duration_cast<milliseconds>(passed / 20);
    std::this_thread::sleep_for(std::clamp(pause, milliseconds(10), milliseconds(100)));
  }
  return true;
}

/// What stands in for hardware or another machine rests between two turns. A test never waits by
/// it: check.waiting has the list of those who may rest.
inline void restBetweenTurns(std::chrono::milliseconds time = std::chrono::milliseconds(2)) {
  std::this_thread::sleep_for(time);
}

}  // namespace hapticast
