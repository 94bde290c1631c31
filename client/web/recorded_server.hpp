// SPDX-License-Identifier: MIT
// The server of a page that plays a recording from a web server: it plays the file to one viewer by
// the messages of the protocol, as --on-demand does. So the viewer in the page is the same in both
// cases. It has no sockets and no clock: the page carries the bytes, and passes the times.
// Thread: one, the worker of the player.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/playback/timeline_player.hpp"

namespace hapticast::client {

/// Plays a recording to one viewer. The recording begins again at its end.
class RecordedServer {
 public:
  /// Opens the recording `file`. Returns an error in one phrase such as "is no MCAP file".
  [[nodiscard]] static Result<RecordedServer> open(const std::string& file);

  /// Processes a message of the viewer that arrived at `now`.
  void receive(std::span<const std::uint8_t> bytes, MediaTime now);
  /// Returns the next message for the viewer that is due at `now`, or nullopt.
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> poll(MediaTime now);
  /// Returns why the recording ends early, as a phrase; empty: it does not.
  [[nodiscard]] const std::string& problem() const { return player_.problem(); }

 private:
  explicit RecordedServer(StreamReader reader);
  void welcome();
  void play(MediaTime now);
  /// Describes the stream to the viewer, if the description changed. Requires a welcomed viewer.
  void describe(MediaTime now);

  TimelinePlayer player_;
  std::deque<std::vector<std::uint8_t>> waiting_;
  bool welcomed_ = false;
};

}  // namespace hapticast::client
