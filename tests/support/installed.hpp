// SPDX-License-Identifier: MIT
// Which programs a test may start. Thread: any.
#pragma once

#include <cstdlib>
#include <string>

namespace hapticast {

/// Returns whether the shell finds `program`. The program is not started: ffmpeg loads 240
/// libraries before it prints its version.
inline bool isInstalled(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null").c_str()) == 0;
}

}  // namespace hapticast
