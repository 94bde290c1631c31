// SPDX-License-Identifier: MIT
// Command line of hapticast-client: flags, config keys and their help.
// Thread: main, at start-up.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "client/settings/settings.hpp"
#include "common/cli/cli11.hpp"
#include "common/cli/subcommands.hpp"

namespace hapticast::client {

/// Subcommands of command lines that name none.
extern const SubcommandChoice kSubcommandChoice;

/// Returns the parser of the command line. Pass it to parseCommandLine(), which then fills
/// `settings`. `settings` must outlive the parser.
[[nodiscard]] std::unique_ptr<CLI::App> commandLine(Settings& settings);

/// Sets the server of `settings` from a text such as on the command line. Throws CLI::Error.
void setServer(Settings& settings, const std::string& text);

/// Fills `settings` from the program's arguments. Returns nullopt on success. Otherwise returns the
/// exit code: 2 after an error (with one line on stderr), or 0 after the help.
[[nodiscard]] std::optional<int> readCommandLine(Settings& settings, int argc,
                                                 const char* const* argv);

}  // namespace hapticast::client
