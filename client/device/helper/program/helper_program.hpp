// SPDX-License-Identifier: MIT
// The program hapticast-device runs one driver in a process of its own. The client starts the
// program. To end it, the client closes the socket between them. Threads: main (list, open, close
// of the driver), loop, and one that watches the socket and the loop.
// Thread: main.
#pragma once

#include <map>
#include <string>

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Arguments of the helper: hapticast-device NAME list|open [KEY=VALUE]... The key `serial` selects
/// one of several devices.
struct HelperTask {
  std::string driver;
  bool list = false;
  std::map<std::string, std::string> options;
};

/// Returns the driver `name` of this program, or null. The table is in built_in_drivers.cpp.
const hapticast_driver* findBuiltInDriver(const std::string& name) noexcept;

/// Runs the task. Returns the exit code of the process: 0, or 1 if the device is absent or the
/// driver cannot be used. The client receives the reason.
int runHelper(const HelperTask& task);

}  // namespace hapticast::client
