// SPDX-License-Identifier: MIT
// Delay of bytes at a TCP connection, from TCP's own figures. It is a file of its own, because the
// kernel's header and that of the C library both define them. Thread: any.
#pragma once

#include <cstddef>

#include "common/time.hpp"

namespace hapticast {

/// Returns how long the last of `bytes` more takes to leave the link of the connection `socket` (a
/// file descriptor): all unconfirmed bytes over the rate. The rate is the one that TCP measured, or
/// if it never sent enough for that, a window in each shortest round trip. Behind a proxy the
/// figures are those of the way to the proxy. Returns 0 if there are no figures.
[[nodiscard]] Duration estimateTcpDelay(int socket, std::size_t bytes) noexcept;

}  // namespace hapticast
