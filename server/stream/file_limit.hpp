// SPDX-License-Identifier: MIT
// Limit of open files (RLIMIT_NOFILE): each connection is an open file. Thread: main.
#pragma once

#include <cstddef>

namespace hapticast::server {

/// Raises this process's limit of open files if `viewers` need it, as far as the system allows.
/// Returns how many viewers fit: `viewers`, or fewer after one log line. Thread: main, before the
/// first connection.
std::size_t raiseFileLimit(std::size_t viewers);

}  // namespace hapticast::server
