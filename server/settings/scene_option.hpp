// SPDX-License-Identifier: MIT
// The flag --scene: applies a scene file to the settings. Flags on the command line and in a config
// file have precedence over it. Points from flags are added to those of the scene. Thread: main, at
// start-up.
#pragma once

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// Adds --scene to `app`. `settings` must outlive `app`.
void addScene(CLI::App& app, Settings& settings);

/// Reads the scene file after the parsing. It sets the flags that the user did not set. Then merges
/// its points and objects with those of the flags: settings.scene has all of the author's work.
/// `app` must have all flags that a scene file may set (kSceneFlags). Throws CLI::ParseError.
void applyScene(CLI::App& app, Settings& settings);

}  // namespace hapticast::server
