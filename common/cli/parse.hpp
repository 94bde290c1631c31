// SPDX-License-Identifier: MIT
// Command line parser with one-line error messages. Thread: main, at start-up.
#pragma once

#include <optional>

#include "common/cli/cli11.hpp"

namespace hapticast {

/// Parses the arguments. Returns nullopt to continue, else the exit code: 2 after one line on
/// stderr, 0 after the help.
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv);

}  // namespace hapticast
