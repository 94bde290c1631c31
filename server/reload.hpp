// SPDX-License-Identifier: MIT
// Reads the command line and its config file again while the server runs (SIGHUP). Some flags take
// effect at once, the others at the next start. Thread: one at a time, the network's.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/settings.hpp"

namespace hapticast::server {

/// Function that reads all settings again. Returns nullopt after an error, which it has logged as
/// one line.
using ReadSettings = std::function<std::optional<Settings>()>;

/// Difference between the running settings and the settings in the files.
struct SettingsChange {
  std::vector<std::string> now;    ///< changes that take effect at once
  std::vector<std::string> later;  ///< changes that take effect at the next start
};

/// Compares two settings by the texts of their flags and by the content of their scene files.
[[nodiscard]] SettingsChange compareSettings(const Settings& running, const Settings& read);

/// The settings of a running server.
class Reloader {
 public:
  /// `settings`: those of the server's start. `read`: reads the new settings; null: reload()
  /// changes nothing.
  Reloader(Settings settings, ReadSettings read)
      : running_(std::move(settings)), read_(std::move(read)) {}

  /// Reads the settings again, applies --quiet, and logs one line. Logs one warning if some changes
  /// take effect only at the next start. Returns the running settings of vision with the new
  /// materials. Returns nullopt, and changes nothing, if the files have an error or `read` is null.
  std::optional<VisionSettings> reload();

 private:
  Settings running_;
  ReadSettings read_;
};

}  // namespace hapticast::server
