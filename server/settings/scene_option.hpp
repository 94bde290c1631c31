// SPDX-License-Identifier: MIT
// The flag --scene: applies a scene file to the settings. Flags on the command line and in a config
// file have precedence over it. Points from flags are added to those of the scene. Thread: main, at
// start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Adds --scene to `app`. `app` must also have all flags that a scene file may set (kSceneFlags).
/// The scene file sets only flags that the user did not set. `settings` must outlive `app`. An
/// error in the scene file ends the parsing, like an error in another flag.
void addScene(CLI::App& app, Settings& settings);

/// Merges the points and objects of the scene with those of the flags, after the parsing.
/// settings.scene then has all of the author's work, from the scene file and from flags.
void mergeScene(const CLI::App& app, Settings& settings);

}  // namespace hapticast::server
