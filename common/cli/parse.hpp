// SPDX-License-Identifier: MIT
// Command line parser with one-line error messages. Thread: main, at start-up.
#pragma once

#include <optional>
#include <string>

#include "common/cli/cli11.hpp"
#include "common/cli/subcommands.hpp"

namespace hapticast {

/// Starts the log under the name of `app`, and parses the arguments of the program. `choice`: how
/// arguments without a subcommand get one (chooseSubcommand()). Returns nullopt if the program has
/// to continue. Otherwise returns the exit code: 2 after an error (with one line in the log), or 0
/// after the help.
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv,
                                    const SubcommandChoice& choice = {});

/// Parses the arguments of the program, and returns nullopt, or the error as one line. Logs
/// nothing. Throws CLI::Success if the arguments ask for the help, the version or a config file.
/// Thread: any.
[[nodiscard]] std::optional<std::string> parseArguments(CLI::App& app, int argc,
                                                        const char* const* argv,
                                                        const SubcommandChoice& choice = {});

/// Checks that this build supports discovery. If it does not, throws CLI::ValidationError with the
/// name of `flag`. Discovery (DNS-SD) finds servers by name. Thread: main, at start-up.
void requireDiscovery(const std::string& flag);

/// Returns `text` if it is a valid service name (isServiceName()). Otherwise throws
/// CLI::ValidationError with the name of `flag`.
[[nodiscard]] std::string serviceName(const std::string& flag, const std::string& text);

}  // namespace hapticast
