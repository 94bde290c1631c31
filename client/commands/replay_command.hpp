// SPDX-License-Identifier: MIT
// Subcommand replay: renders a recorded run again and writes its results. Thread: main.
#pragma once

#include "client/settings/settings.hpp"

namespace hapticast::client {

/// Renders the recording `settings.replay_file`, with the settings that the user gave. Prints one
/// line with the number of ticks and their differences. Returns the exit code.
int runReplay(const Settings& settings);

}  // namespace hapticast::client
