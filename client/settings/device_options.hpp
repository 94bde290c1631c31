// SPDX-License-Identifier: MIT
// Flags of the haptic device. Thread: main, at start-up.
#pragma once

#include <map>
#include <string>

#include "client/settings/settings.hpp"
#include "common/cli/options.hpp"

namespace hapticast::client {

// Each adds flags to `app`, which write to `settings`. `settings` must outlive `app`.
/// Adds the flags of the device of a run, with its virtual hand.
void addDeviceOptions(CLI::App& app, Settings& settings);
/// Adds the flags that find and open a device: its profile and the settings of its driver.
void addDriverOptions(CLI::App& app, Settings& settings);
void addStiffnessLimit(CLI::App& app, Settings& settings);

/// Adds an option for a kind of device of this build, or auto.
CLI::Option* addDeviceKind(CLI::App& app, const std::string& name, std::string& kind,
                           const std::string& help);

}  // namespace hapticast::client
