// SPDX-License-Identifier: MIT
// hapticast-client's command line: flags, config keys and their help. Thread: main, at start-up.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>

#include "client/settings.hpp"

namespace hapticast::client {

/// Returns the command line that fills `settings`, which outlives it. Parse with
/// parseCommandLine().
[[nodiscard]] std::unique_ptr<CLI::App> commandLine(Settings& settings);

}  // namespace hapticast::client
