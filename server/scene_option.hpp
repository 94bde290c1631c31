// SPDX-License-Identifier: MIT
// The flag --scene: applies a scene file to the settings. Flags on the command line and in a config
// file win over it. Their points add to those of the scene. Thread: main, at start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings.hpp"

namespace hapticast::server {

/// Adds --scene to `app`. `app` must also have all flags that a scene file may set (kSceneFlags).
/// The scene file sets those that the user did not set. `settings` must outlive `app`. An error in
/// the scene file ends the parsing, like an error in another flag.
void addScene(CLI::App& app, Settings& settings);

/// Merges the points and objects of the scene with those of the flags, after the parsing. Then
/// settings.scene has all of the author's work, whichever way it came.
void mergeScene(const CLI::App& app, Settings& settings);

}  // namespace hapticast::server
