// SPDX-License-Identifier: MIT
#include "common/installed_file.hpp"

#include <filesystem>
#include <system_error>

namespace hapticast {

std::string findInstalledFile(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path own = fs::read_symlink("/proc/self/exe", error).parent_path() / name;
  for (const fs::path& path : {own, fs::path("/usr/lib/hapticast") / name}) {
    if (fs::is_regular_file(path, error)) return path.string();
  }
  return own.string();
}

}  // namespace hapticast
