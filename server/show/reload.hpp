// SPDX-License-Identifier: MIT
// Reads the command line and its config file again while the server runs (SIGHUP). Some flags take
// effect at once, the others at the next start. Thread: one at a time, the network's.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/result.hpp"
#include "server/settings/settings.hpp"
#include "server/stream/limited_log.hpp"

namespace hapticast::server {

/// Function that reads all settings again. Returns an error of one line if a file has an error.
using ReadSettings = std::function<Result<Settings>()>;

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
  /// changes nothing. `clock` must outlive this object.
  Reloader(Settings settings, ReadSettings read, const Clock& clock)
      : running_(std::move(settings)), read_(std::move(read)), log_(clock) {}

  /// Reads the settings again, applies --quiet, and logs one line. Logs one warning if some changes
  /// take effect only at the next start. Returns the running settings of vision with the new
  /// materials. Returns nullopt, and changes nothing, if the files have an error, which it logs, or
  /// if `read` is null. The lines have a limit (LimitedLog).
  std::optional<VisionSettings> reload();

 private:
  Settings running_;
  ReadSettings read_;
  LimitedLog log_;
};

}  // namespace hapticast::server
