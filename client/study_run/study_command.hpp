// SPDX-License-Identifier: MIT
// Subcommand study: runs a study with one subject (client/study/README.md). Thread: main.
#pragma once

#include "client/settings/settings.hpp"
#include "client/view/view.hpp"

namespace hapticast::client {

/// Runs the study `settings.study` in `views`. Returns the exit code. Errors before the first trial
/// are logged in one line, with the file and the line of the study where it has one.
int runStudy(const Settings& settings, const Clock& clock, Views views);

}  // namespace hapticast::client
