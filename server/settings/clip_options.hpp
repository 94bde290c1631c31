// SPDX-License-Identifier: MIT
// Flags of a clip: its files, how vision finds the objects, and their material. The subcommands
// serve, preview and bake have them. Thread: main, at start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Adds the flags of a clip to `app`. They write to `settings`, which must outlive `app`.
void addClipOptions(CLI::App& app, Settings& settings);

/// Checks the flags of a clip after the parsing, and merges the scene file with them. Throws
/// CLI::ValidationError for flags that contradict each other.
void finishClip(CLI::App& app, Settings& settings);

/// Checks that no flag of a clip was given, because the source is a recording of hapticast. Throws
/// CLI::ValidationError.
void refuseClipOptions(const CLI::App& app);

}  // namespace hapticast::server
