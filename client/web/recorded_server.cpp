// SPDX-License-Identifier: MIT
#include "client/web/recorded_server.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace hapticast::client {

RecordedServer::RecordedServer(StreamReader reader)
    : player_(std::move(reader), true), recorded_(player_.reader().description()) {}

Result<RecordedServer> RecordedServer::open(const std::string& file) {
  auto reader = StreamReader::open(file);
  if (!reader.ok()) return reader.error();
  return RecordedServer(std::move(reader).value());
}

void RecordedServer::receive(std::span<const std::uint8_t> bytes, MediaTime now) {
  const auto message = decode(bytes);
  if (!message.ok()) {
    waiting_.push_back(encode(message.error()));
  } else if (std::holds_alternative<Hello>(message.value())) {
    welcome();
  } else if (const auto* const ping = std::get_if<Ping>(&message.value())) {
    waiting_.push_back(encode(Pong{ping->t0, now, now, {}}));
  } else if (const auto* const control = std::get_if<Control>(&message.value())) {
    carryOut(*control);
    if (welcomed_ && paused_) describe(now);  // else with the next frame
  }
}

void RecordedServer::welcome() {
  waiting_.clear();
  sent_ = describePlayback(recorded_, player_.speed(), "");
  sent_.timeline = player_.timeline();
  sent_.timeline->position_s = place_s_;
  waiting_.push_back(encode(Welcome{kProtocolVersion, 1, 0, sent_}));
  welcomed_ = true;
}

void RecordedServer::carryOut(const Control& control) {
  if (control.paused) {
    if (paused_ && !*control.paused) player_.resume();
    paused_ = *control.paused;
  }
  if (control.speed) player_.setSpeed(*control.speed);
  if (!control.seek_s) return;
  player_.seek(*control.seek_s);
  place_s_ = *control.seek_s;
}

std::optional<std::vector<std::uint8_t>> RecordedServer::poll(MediaTime now) {
  if (waiting_.empty() && welcomed_ && !paused_) play(now);
  if (waiting_.empty()) return std::nullopt;
  std::vector<std::uint8_t> message = std::move(waiting_.front());
  waiting_.pop_front();
  return message;
}

void RecordedServer::play(MediaTime now) {
  const auto due = player_.prepare(now);
  if (!due || *due > now) return;
  RecordedItem item = player_.take();
  if (auto* const description = std::get_if<StreamDescription>(&item)) {
    recorded_ = std::move(*description);
  } else if (auto* const frame = std::get_if<CodedFrame>(&item)) {
    place_s_ = player_.timeline().computePosition_s(frame->media_time);
    describe(now);
    waiting_.push_back(encode(*frame));
  } else {
    waiting_.push_back(encode(std::get<VideoFrame>(item)));
  }
}

void RecordedServer::describe(MediaTime now) {
  StreamDescription description = describePlayback(recorded_, player_.speed(), "");
  Timeline timeline = player_.timeline();
  if (paused_) {
    timeline.position_s = std::clamp(place_s_, 0.0, timeline.length_s);
    timeline.at = sent_.timeline->speed == 0.0 ? sent_.timeline->at : now;
    timeline.speed = 0.0;
  }
  description.timeline = timeline;
  if (description == sent_) return;
  sent_ = std::move(description);
  waiting_.push_back(encode(sent_));
}

}  // namespace hapticast::client
