// SPDX-License-Identifier: MIT
// Finds files that belong to a program of the project. Thread: any, but not the haptic loop
// (asks the disk).
#pragma once

#include <string>

namespace hapticast {

/// Finds the file `name` in the folder of the running program, else in /usr/lib/hapticast. Returns
/// its path. If neither folder has the file, returns the path in the folder of the running program.
[[nodiscard]] std::string findInstalledFile(const std::string& name);

}  // namespace hapticast
