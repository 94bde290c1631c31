// SPDX-License-Identifier: MIT
// hapticast-server's command line: flags, config keys and their help. Thread: main, at start-up.
#pragma once

#include <memory>
#include <optional>

#include "common/cli/cli11.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// Returns the command line that fills `settings`, which must outlive it. Parse it with
/// parseCommandLine().
[[nodiscard]] std::unique_ptr<CLI::App> commandLine(Settings& settings);

/// Fills `settings` from the program's arguments. Returns nullopt to continue, else the exit code:
/// 2 after one line on stderr, 0 after the help.
[[nodiscard]] std::optional<int> readCommandLine(Settings& settings, int argc,
                                                 const char* const* argv);

}  // namespace hapticast::server
