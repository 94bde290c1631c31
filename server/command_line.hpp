// SPDX-License-Identifier: MIT
// hapticast-server's command line: flags, config keys and their help. Thread: main, at start-up.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "server/settings.hpp"

namespace hapticast::server {

/// Returns the command line that fills `settings`, which outlives it. Parse with
/// parseCommandLine().
[[nodiscard]] std::unique_ptr<CLI::App> commandLine(Settings& settings);

}  // namespace hapticast::server
