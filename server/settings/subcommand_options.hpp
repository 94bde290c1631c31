// SPDX-License-Identifier: MIT
// The subcommands of hapticast-server, each with its flags. Thread: main, at start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Add a subcommand with its flags to `program`. They write to `settings`, which must outlive
/// `program`.
void addServeCommand(CLI::App& program, Settings& settings);
void addRelayCommand(CLI::App& program, Settings& settings);
void addPreviewCommand(CLI::App& program, Settings& settings);
void addBakeCommand(CLI::App& program, Settings& settings);

/// Adds --frames to `app`. It writes to `frames`, which must outlive `app`.
void addFrames(CLI::App& app, std::uint64_t& frames);

}  // namespace hapticast::server
