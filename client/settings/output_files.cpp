// SPDX-License-Identifier: MIT
// Checks of the files that a run will write (settings.hpp).
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include "client/settings/settings.hpp"

namespace hapticast::client {

namespace {

/// Returns whether two names are of one file. The files need not exist.
bool isSameFile(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::exists(a, error) && !fs::is_regular_file(a, error)) return false;  // /dev/null
  if (fs::equivalent(a, b, error)) return true;
  const auto resolve = [&error](const std::string& file) {
    return fs::weakly_canonical(fs::absolute(file, error), error);
  };
  return resolve(a) == resolve(b);
}

}  // namespace

void requireDistinctOutputs(const Settings& settings) {
  const std::array<std::pair<const char*, const std::string*>, 6> outputs{
      {{"--log", &settings.log_file},
       {"--summary", &settings.summary_file},
       {"--screenshot", &settings.screenshot_file},
       {"--film", &settings.film_file},
       {"--record", &settings.outputs.record},
       {"--replay", &settings.replay_file}}};
  for (const auto& [flag, file] : outputs) {
    for (const auto& [earlier, other] : outputs) {
      if (other == file) break;
      if (file->empty() || other->empty() || !isSameFile(*file, *other)) continue;
      throw std::runtime_error(std::string(flag) + " " + *file + ": is the file of " + earlier +
                               ", too; name another file");
    }
  }
}

}  // namespace hapticast::client
