// SPDX-License-Identifier: MIT
// The subcommands of hapticast-client, each with its flags. Thread: main, at start-up.
#pragma once

#include "client/settings/settings.hpp"
#include "common/cli/cli11.hpp"

namespace hapticast::client {

/// Add a subcommand with its flags to `program`. They write to `settings`, which must outlive
/// `program`.
void addTouchCommand(CLI::App& program, Settings& settings);
void addReplayCommand(CLI::App& program, Settings& settings);
void addStudyCommand(CLI::App& program, Settings& settings);
void addCheckCommand(CLI::App& program, Settings& settings);
void addListCommand(CLI::App& program, Settings& settings);
void addControlCommand(CLI::App& program, Settings& settings);

}  // namespace hapticast::client
