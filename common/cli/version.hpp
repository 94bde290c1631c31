// SPDX-License-Identifier: MIT
// Version text of a program, with its optional packages. Thread: any.
#pragma once

#include <string>

#include "common/cli/cli11.hpp"

namespace hapticast {

/// Adds --version and appends the same text to --help: "PROGRAM VERSION (`built_in`)", then a line
/// with the optional packages of this build.
void addVersion(CLI::App& app, const std::string& built_in);

}  // namespace hapticast
