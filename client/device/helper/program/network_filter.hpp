// SPDX-License-Identifier: MIT
// Blocks the network for the helper process by a seccomp filter. A driver that needs the network to
// reach its device declares that (HAPTICAST_NEEDS_NETWORK), and its process has no filter.
// Thread: main, before the driver starts threads.
#pragma once

namespace hapticast::client {

/// Blocks new IPv4, IPv6 and packet sockets, and io_uring, until the process ends: socket() then
/// fails with EACCES. Returns false if the kernel has no seccomp.
bool refuseNetwork() noexcept;

}  // namespace hapticast::client
