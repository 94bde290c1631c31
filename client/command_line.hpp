// SPDX-License-Identifier: MIT
// Command line of hapticast-client: flags, config keys and their help.
// Thread: main, at start-up.
#pragma once

#include <memory>
#include <optional>

#include "client/settings.hpp"
#include "common/cli/cli11.hpp"

namespace hapticast::client {

/// Returns the command line that fills `settings`, which must outlive it. Parse it with
/// parseCommandLine().
[[nodiscard]] std::unique_ptr<CLI::App> commandLine(Settings& settings);

/// Fills `settings` from the program's arguments. Returns nullopt on success, else the exit code: 2
/// after an error (one line on stderr), 0 after the help.
[[nodiscard]] std::optional<int> readCommandLine(Settings& settings, int argc,
                                                 const char* const* argv);

}  // namespace hapticast::client
