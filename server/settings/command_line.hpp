// SPDX-License-Identifier: MIT
// hapticast-server's command line: flags, keys of the configuration file, and their help.
// Thread: main, at start-up, except where a function states another one.
#pragma once

#include <memory>
#include <optional>

#include "common/cli/cli11.hpp"
#include "common/cli/subcommands.hpp"
#include "common/result.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Subcommands of command lines that name none.
extern const SubcommandChoice kSubcommandChoice;

/// Returns the parser of the command line. It writes into `settings`, which must outlive it. Parse
/// the arguments with parseCommandLine() and kSubcommandChoice.
[[nodiscard]] std::unique_ptr<CLI::App> commandLine(Settings& settings);

/// Writes the program's arguments into `settings`. Returns nullopt if the program should continue.
/// If it should end, returns its exit code: 2 after one line on stderr, or 0 after the help.
[[nodiscard]] std::optional<int> readCommandLine(Settings& settings, int argc,
                                                 const char* const* argv);

/// Reads the same arguments again, with the present content of the files that they name. Returns an
/// error of one line if an argument or a file has an error. Thread: any.
Result<Settings> rereadCommandLine(int argc, const char* const* argv);

}  // namespace hapticast::server
