// SPDX-License-Identifier: MIT
// File names for output files that the user did not name. Thread: any.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace hapticast {

/// Returns the first of the names hapticast-1, hapticast-2, ... that does not exist in the working
/// folder. Each name has the extension `ending`, such as ".csv".
inline std::string nextFreeFilename(const std::string& ending) {
  std::string name;
  std::error_code unknown;  // an error counts as not existing
  int number = 1;
  do {
    name = "hapticast-" + std::to_string(number++) + ending;
  } while (std::filesystem::exists(name, unknown));
  return name;
}

}  // namespace hapticast
