// SPDX-License-Identifier: MIT
// What a program says of itself: its version and what is built in. Thread: any.
#pragma once

#include <string>

#include "common/cli/cli11.hpp"

namespace hapticast {

/// Adds --version, and ends --help with the same text: "PROGRAM VERSION (`built_in`)", and on a
/// second line which optional packages this build has found.
void addVersion(CLI::App& app, const std::string& built_in);

}  // namespace hapticast
