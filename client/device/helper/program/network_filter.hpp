// SPDX-License-Identifier: MIT
// Takes the network from the helper process: a seccomp filter refuses internet sockets. A driver
// whose device is reached through a network declares that (HAPTICAST_NEEDS_NETWORK).
// Thread: main, before the driver starts threads.
#pragma once

namespace hapticast::client {

/// Refuses new IPv4, IPv6 and packet sockets, and io_uring, in this process for ever: socket() then
/// fails with EACCES. Returns false if the kernel has no seccomp.
bool refuseNetwork() noexcept;

}  // namespace hapticast::client
