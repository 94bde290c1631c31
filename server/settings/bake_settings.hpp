// SPDX-License-Identifier: MIT
// Settings and command line of `hapticast-server bake`. Thread: main, at start-up.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/cli/cli11.hpp"
#include "server/settings/settings.hpp"

namespace hapticast::server {

/// First word of the command line that asks for a bake.
inline constexpr const char* kBakeCommand = "bake";

/// Values of the flags; --help describes each.
struct BakeSettings {
  Settings server;     ///< source, vision and --quiet
  std::string out;     ///< FILE.mcap, which does not exist
  std::string folder;  ///< of a page that plays the file, with a slash at its end; empty: none
  bool resume = false;
  int picture_quality = 80;  ///< of the JPEGs, 1..100
  std::string flags;         ///< the flags that change the frames, as one text
};

/// Returns the parser of the words behind `bake`. It writes into `settings`, which must outlive it.
[[nodiscard]] std::unique_ptr<CLI::App> bakeCommandLine(BakeSettings& settings);

/// Writes the program's arguments into `settings`. Returns nullopt, or the exit code as
/// readCommandLine() does. Requires `bake` as first argument.
[[nodiscard]] std::optional<int> readBakeCommandLine(BakeSettings& settings, int argc,
                                                     const char* const* argv);

}  // namespace hapticast::server
