// SPDX-License-Identifier: MIT
// Command line parser with one-line error messages. Thread: main, at start-up.
#pragma once

#include <optional>
#include <string>

#include "common/cli/cli11.hpp"

namespace hapticast {

/// Parses the arguments. Returns nullopt to continue, else the exit code: 2 after one line on
/// stderr, 0 after the help.
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv);

// Names of servers on the command line, and whether this build supports discovery (DNS-SD). Thread:
// main, at start-up.

/// Throws CLI::ValidationError with `flag` in a build without discovery.
void requireDiscovery(const std::string& flag);

/// Returns `text` if it is a valid service name; throws CLI::ValidationError otherwise.
[[nodiscard]] std::string serviceName(const std::string& flag, const std::string& text);

}  // namespace hapticast
