// SPDX-License-Identifier: MIT
// The effect of some viewers on a server and on the others. Thread: main.
#pragma once

#include "common/time.hpp"
#include "tests/bench/viewers/contest.hpp"

namespace hapticast::testing {

/// Viewers come and go at random, every 20th of them dies in the middle of a message; every byte
/// that any of them gets is compared with what the others got. Says once a minute what happened and
/// what the server takes; throws std::runtime_error where anything was wrong.
void churn(Contestant who, const Frames& frames, Duration time);

/// Turns without and with so many viewers that say hello and read nothing; says what the others got
/// and what memory that took, the system's included.
void stall(Contestant who, const Frames& frames, std::size_t stalled, Duration time);

/// Turns without and with so many viewers by WebSocket, which want no pictures; says what the
/// others got.
void besideBrowsers(Contestant who, const Frames& frames, std::size_t browsers, Duration time);

}  // namespace hapticast::testing
