// SPDX-License-Identifier: MIT
// The flag --scene: applies a scene file to the settings. Flags on the command line and in a config
// file win over it. Their points add to those of the scene. Thread: main, at start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// Adds --scene to `app`, which must have all other flags already. The file sets the flags that the
/// user did not set. `settings` must outlive `app`. Errors in the file end the parsing, as those of
/// other flags do.
void addScene(CLI::App& app, Settings& settings);

/// Merges the points and objects of the scene with those of the flags, after the parsing. Then
/// settings.scene has all of the author's work, whichever way it came.
void mergeScene(const CLI::App& app, Settings& settings);

}  // namespace hapticast::server
