// SPDX-License-Identifier: MIT
// A connection is an open file, and a system allows a process only so many.
#pragma once

#include <cstddef>

namespace hapticast::server {

/// Raises this process's limit of open files as far as the system allows, if `viewers` need it, and
/// returns how many viewers fit: `viewers`, or fewer, which is told in one line of the log. Thread:
/// main, before connections come.
std::size_t raiseFileLimit(std::size_t viewers);

}  // namespace hapticast::server
