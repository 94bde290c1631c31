// SPDX-License-Identifier: MIT
#include "server/stream/key_file.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <system_error>

namespace hapticast::server {

std::optional<std::string> findReaders(const std::string& flag, const std::string& file,
                                       const std::string& risk) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto mode = static_cast<unsigned>(fs::status(file, error).permissions());
  constexpr auto kOthers = static_cast<unsigned>(fs::perms::group_all | fs::perms::others_all);
  if (error || (mode & kOthers) == 0) return std::nullopt;
  return fmt::format("{} {}: other users may use this file (mode {:04o}) and {}; chmod 600 {}",
                     flag, file, mode & 0777U, risk, file);
}

}  // namespace hapticast::server
