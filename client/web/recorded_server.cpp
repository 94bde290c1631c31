// SPDX-License-Identifier: MIT
#include "client/web/recorded_server.hpp"

#include <utility>
#include <variant>

namespace hapticast::client {

RecordedServer::RecordedServer(StreamReader reader)
    : player_(RecordingPlayer(std::move(reader), true), "") {}

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
    player_.carryOut(*control);
    if (welcomed_ && player_.rests()) describe(now);  // else with the next frame
  }
}

void RecordedServer::welcome() {
  waiting_.clear();
  waiting_.push_back(encode(Welcome{kProtocolVersion, 1, 0, player_.description()}));
  welcomed_ = true;
}

std::optional<std::vector<std::uint8_t>> RecordedServer::poll(MediaTime now) {
  if (waiting_.empty() && welcomed_ && !player_.rests()) play(now);
  if (waiting_.empty()) return std::nullopt;
  std::vector<std::uint8_t> message = std::move(waiting_.front());
  waiting_.pop_front();
  return message;
}

void RecordedServer::play(MediaTime now) {
  const auto due = player_.prepare(now);
  if (!due || *due > now) return;
  const RecordedItem item = player_.take();
  if (const auto* const frame = std::get_if<CodedFrame>(&item)) {
    describe(now);
    waiting_.push_back(encode(*frame));
  } else if (const auto* const picture = std::get_if<VideoFrame>(&item)) {
    waiting_.push_back(encode(*picture));
  }
}

void RecordedServer::describe(MediaTime now) {
  if (player_.updateDescription(now)) waiting_.push_back(encode(player_.description()));
}

}  // namespace hapticast::client
