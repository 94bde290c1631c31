// SPDX-License-Identifier: MIT
// Playback of a recording for one viewer, who may pause, seek, and set the speed. The description
// of the stream has the place in the recording, and follows each change. The owner sends the items:
// a server over a network, or the player in a web page. Thread: one.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "common/playback/recording_player.hpp"

namespace hapticast {

/// Returns the description of the stream before the first frame. `name`: of the stream; empty: as
/// recorded.
[[nodiscard]] StreamDescription describeBegin(const RecordingPlayer& player,
                                              const std::string& name);

/// The playback for one viewer.
class TimelinePlayer {
 public:
  TimelinePlayer(RecordingPlayer player, std::string name);

  /// Carries out a request for a pause, a place or a speed. Returns whether it has changed the
  /// place.
  bool carryOut(const Control& request);
  /// Returns whether the playback waits for a request: it is paused, or at the end.
  [[nodiscard]] bool rests() const { return paused_ || at_end_; }
  /// Makes the playback rest at its place, until a request for another place.
  void stopAtEnd() { at_end_ = true; }
  /// Prepares the next item as RecordingPlayer::prepare() does.
  [[nodiscard]] std::optional<MediaTime> prepare(MediaTime now) { return player_.prepare(now); }
  /// Returns the prepared item. A description in it is that of the recording: the viewer gets the
  /// one of updateDescription(), before the frame that follows.
  [[nodiscard]] RecordedItem take();

  /// Returns the description that the viewer has.
  [[nodiscard]] const StreamDescription& description() const { return sent_; }
  /// Makes the description that of `now`. Returns whether it differs from the one before, so that
  /// the viewer needs it.
  [[nodiscard]] bool updateDescription(MediaTime now);
  /// Returns why the recording ends early (RecordingPlayer::problem()).
  [[nodiscard]] const std::string& problem() const { return player_.problem(); }

 private:
  RecordingPlayer player_;
  std::string name_;
  StreamDescription recorded_;  // the newest description in the recording
  StreamDescription sent_;
  double place_s_ = 0.0;  // of the last frame
  bool paused_ = false, at_end_ = false;
};

}  // namespace hapticast
