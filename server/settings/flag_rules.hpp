// SPDX-License-Identifier: MIT
// Flags that need or exclude each other. Thread: main, at start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Refuses flags that this server cannot obey, after the parsing. Sets whether the
/// source is a recording. With --on-demand, switches the datagrams off. Throws
/// CLI::ValidationError.
void requireFlags(const CLI::App& app, Settings& settings);

}  // namespace hapticast::server
