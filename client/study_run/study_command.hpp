// SPDX-License-Identifier: MIT
// Subcommand study: runs a study with one subject (client/study/README.md). Thread: main.
#pragma once

#include "client/settings/settings.hpp"
#include "common/time.hpp"

namespace hapticast::client {

/// Runs the study `settings.study`. Returns the exit code. Throws std::runtime_error
/// with one line if the study cannot begin; it has the line of the study file where there is one.
int runStudy(const Settings& settings, const Clock& clock);

}  // namespace hapticast::client
