// SPDX-License-Identifier: MIT
// Where the real clips are, for tests and measurements that use them when present.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace hapticast::test {

/// $HAPTICAST_CLIPS, else beside the project.
inline std::filesystem::path clipsFolder() {
  const char* named = std::getenv("HAPTICAST_CLIPS");
  return named != nullptr ? named : HAPTICAST_CLIPS;
}

}  // namespace hapticast::test
