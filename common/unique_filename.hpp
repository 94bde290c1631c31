// SPDX-License-Identifier: MIT
// Names for files that a user asks for without naming them. Thread: any.
#pragma once

#include <filesystem>
#include <string>
#include <system_error>

namespace hapticast {

/// hapticast-1.csv, hapticast-2.csv, ...: the first one, of this `ending`, that is not yet in the
/// working folder.
inline std::string nextFreeFilename(const std::string& ending) {
  std::string name;
  std::error_code unknown;  // such a file is not there either
  int number = 1;
  do {
    name = "hapticast-" + std::to_string(number++) + ending;
  } while (std::filesystem::exists(name, unknown));
  return name;
}

}  // namespace hapticast
