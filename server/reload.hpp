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

/// Difference between running settings and those of the files.
struct SettingsChange {
  std::vector<std::string> now;    ///< what takes effect at once
  std::vector<std::string> later;  ///< what takes effect at the next start
};

/// Compares two settings by the texts of their flags and by the content of their scene files.
[[nodiscard]] SettingsChange compareSettings(const Settings& running, const Settings& read);

/// The settings of a running server.
class Reloader {
 public:
  /// `settings`: those of the start. `read`: null if a reload changes nothing.
  Reloader(Settings settings, ReadSettings read)
      : running_(std::move(settings)), read_(std::move(read)) {}

  /// Reads the settings again, applies --quiet, and logs one line, and one warning if some changes
  /// have no effect yet. Returns the running settings with the new materials. Returns nullopt if
  /// the files have an error. All settings then stay as they are.
  std::optional<VisionSettings> reload();

 private:
  Settings running_;
  ReadSettings read_;
};

}  // namespace hapticast::server
