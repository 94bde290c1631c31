// SPDX-License-Identifier: MIT
// Drivers that are installed as shared libraries. The driver NAME is the file NAME.so in one of two
// folders: hapticast/devices in $XDG_DATA_HOME (else ~/.local/share), and a system folder. The
// functions never search the working folder. They refuse a file or folder that another user owns or
// may write, because a driver is code.
// Thread: main.
#pragma once

#include <string>
#include <vector>

#include "client/device/hapticast_device.h"

namespace hapticast::client {

/// Returns the folders of drivers, the user's first.
std::vector<std::string> driverFolders();

/// Returns true if `name` is a valid name of a driver: 1 to 32 of [a-z0-9_].
[[nodiscard]] bool isDriverName(const std::string& name) noexcept;

/// Returns the sorted names of the drivers in `folders`.
std::vector<std::string> listDriverFiles(const std::vector<std::string>& folders);

/// Loads the driver `name` from the first of `folders` with such a file. Returns null if no folder
/// has the file. The library stays loaded until the process ends. Throws std::runtime_error (one
/// line with the file and the remedy) if the file cannot be used.
const hapticast_driver* loadDriverFile(const std::string& name,
                                       const std::vector<std::string>& folders);

}  // namespace hapticast::client
