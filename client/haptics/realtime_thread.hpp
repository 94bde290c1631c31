// SPDX-License-Identifier: MIT
// Asks the system to treat the calling thread as the 1 kHz loop's.
#pragma once

namespace hapticast::client {

struct RealtimeGrant {
  bool fifo = false;   ///< the thread runs under SCHED_FIFO
  bool mlock = false;  ///< the process's memory, present and future, stays in RAM
};

/// Asks for both; not getting them is no error. Thread: the one that will run the loop, before it
/// does.
RealtimeGrant requestRealtime() noexcept;

/// From now on numbers below 2.2e-308 are zero on the calling thread and those it starts: filters
/// at rest decay to them, and the processor takes a hundred times as long over them.
void flushDenormals() noexcept;

}  // namespace hapticast::client
