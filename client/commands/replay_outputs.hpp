// SPDX-License-Identifier: MIT
// Files that a replay can write besides the log: another recording (--record), a film (--film) and
// a picture (--screenshot). Thread: main.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/recording/run_channels.hpp"
#include "client/settings/settings.hpp"
#include "client/view/view.hpp"
#include "common/recording/mcap_writer.hpp"

namespace hapticast::client {

/// A recording with the messages of the replayed one, without its log, and the new ticks.
class ReplayRecording {
 public:
  /// Creates `file`. Throws RecordingError.
  explicit ReplayRecording(const std::string& file);
  /// Add a tick, and another message.
  void onTick(const TickReport& report);
  void onMessage(RunChannel channel, std::uint64_t time_ns, std::span<const std::uint8_t> data);
  /// Completes the file. Throws RecordingError if the file system has refused messages.
  void finish();

 private:
  void writeTicks();

  std::string file_;
  std::optional<McapWriter> writer_;
  std::vector<TickReport> ticks_;  // of the next message
};

/// The views of a replay. Their time is that of the ticks: a slow view delays the replay.
class ReplayViews {
 public:
  /// Opens the views of --film and --screenshot. Throws std::runtime_error with one line.
  explicit ReplayViews(Settings settings);
  /// Receives a tick, whose `time` counts from the first one, and another message.
  void onTick(const TickReport& report);
  void onMessage(RunChannel channel, std::span<const std::uint8_t> data);
  /// Writes the files as finishViews() does.
  [[nodiscard]] bool finish();

 private:
  void update();

  Views views_;
  UiState state_;
  std::optional<Workspace> workspace_;  // of the newest description
};

}  // namespace hapticast::client
