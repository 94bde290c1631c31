// SPDX-License-Identifier: MIT
// Reading a whole command line, and what a person is told when it is wrong. Thread: main, at
// start-up.
#pragma once

#include <optional>

#include "common/cli/cli11.hpp"

namespace hapticast {

/// Parses; nullopt: go on. Otherwise the exit code to leave with, after one line on stderr (2) or
/// the help (0).
std::optional<int> parseCommandLine(CLI::App& app, int argc, const char* const* argv);

}  // namespace hapticast
