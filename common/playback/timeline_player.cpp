// SPDX-License-Identifier: MIT
#include "common/playback/timeline_player.hpp"

#include <algorithm>
#include <variant>

namespace hapticast {

StreamDescription describeBegin(const RecordingPlayer& player, const std::string& name) {
  StreamDescription description = describePlayback(player.reader().description(), 1.0, name);
  description.timeline = player.timeline();
  description.timeline->position_s = 0.0;
  return description;
}

TimelinePlayer::TimelinePlayer(RecordingPlayer player, std::string name)
    : player_(std::move(player)),
      name_(std::move(name)),
      recorded_(player_.reader().description()),
      sent_(describeBegin(player_, name_)) {}

bool TimelinePlayer::carryOut(const Control& request) {
  if (request.paused) {
    if (paused_ && !*request.paused) player_.resume();
    paused_ = *request.paused;
  }
  if (request.speed) player_.setSpeed(*request.speed);
  if (!request.seek_s) return false;
  player_.seek(*request.seek_s);
  place_s_ = *request.seek_s;
  at_end_ = false;
  return true;
}

RecordedItem TimelinePlayer::take() {
  RecordedItem item = player_.take();
  if (const auto* const description = std::get_if<StreamDescription>(&item))
    recorded_ = *description;
  else if (const auto* const frame = std::get_if<CodedFrame>(&item))
    place_s_ = player_.timeline().computePosition_s(frame->media_time);
  return item;
}

bool TimelinePlayer::updateDescription(MediaTime now) {
  StreamDescription description = describePlayback(recorded_, player_.speed(), name_);
  Timeline timeline = player_.timeline();
  if (rests()) {
    timeline.position_s =
        std::clamp(at_end_ ? timeline.length_s : place_s_, 0.0, timeline.length_s);
    timeline.at = sent_.timeline->speed == 0.0 ? sent_.timeline->at : now;
    timeline.speed = 0.0;
  }
  description.timeline = timeline;
  if (description == sent_) return false;
  sent_ = std::move(description);
  return true;
}

}  // namespace hapticast
