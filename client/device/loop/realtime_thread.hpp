// SPDX-License-Identifier: MIT
// Real-time properties of the calling thread: the scheduling class SCHED_FIFO, locked memory, and
// zero in place of denormal numbers.
// Thread: the thread of the 1 kHz loop, before the first tick.
#pragma once

namespace hapticast::client {

/// Real-time properties that the system granted.
struct RealtimeGrant {
  bool fifo = false;  ///< the thread runs under SCHED_FIFO
  /// All memory of the process stays in RAM once it is used. The loop's code is loaded in advance.
  bool mlock = false;
};

/// Requests SCHED_FIFO and locked memory from the system, for the calling thread. Returns the
/// properties that the system granted. A refusal is no error. The priority is that of the client's
/// loop plus `above`. Call it when the thread begins.
RealtimeGrant requestRealtime(int above = 0) noexcept;

/// Makes the calling thread, and the threads that it starts, treat numbers below 2.2e-308 as zero.
/// Filters without input decay to such numbers, and the processor needs up to a hundred times as
/// long to compute with them.
void flushDenormals() noexcept;

}  // namespace hapticast::client
