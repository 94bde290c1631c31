// SPDX-License-Identifier: MIT
// The subcommands of hapticast-client. Thread: main.
#pragma once

#include "client/settings/settings.hpp"

namespace hapticast::client {

/// Runs the subcommand of `settings`, other than list. Returns its exit code. Throws DeviceAbsent
/// and other failures at run time as std::runtime_error with one line.
int runCommand(const Settings& settings);
/// Prints the servers or the devices of this machine. Returns the exit code.
int runList(const Settings& settings);

}  // namespace hapticast::client
