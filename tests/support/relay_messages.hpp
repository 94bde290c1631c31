// SPDX-License-Identifier: MIT
// Relayed messages of origins with any key and any numbers, for tests. Thread: any.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/protocol/relay.hpp"
#include "common/transport/datagram.hpp"

namespace hapticast::server {

inline constexpr std::uint64_t kTestOrigin = (std::uint64_t{5} << 32U) | 77;

/// Returns a valid state of the origin `origin` with the key `key`.
inline RelayState makeState(const SigningKey& key, std::uint64_t origin = kTestOrigin) {
  RelayState state;
  state.description.name = "clip";
  state.stream = static_cast<std::uint32_t>(origin);
  state.verifying_key = key.verifyingKey();
  state.probe.resize(kMostDatagramBytes - kTokenBytes);
  return state;
}

/// Returns a frame with 100 bytes that are no message.
inline RelayFrame makeFrame(std::uint64_t id, std::uint32_t epoch = 1) {
  RelayFrame frame;
  frame.epoch = epoch;
  frame.id = id;
  frame.delta = std::make_shared<const std::vector<std::uint8_t>>(100, std::uint8_t{1});
  return frame;
}

/// Returns a whole message with a valid signature by `key`.
inline std::vector<std::uint8_t> makeMessage(SigningKey& key, RelayHead head,
                                             const RelayContent& content,
                                             const std::string& channel = "lab") {
  return encodeRelay(channel, head, content, [&key](auto bytes) { return key.sign(bytes); });
}

/// Returns numbers at the limits of their types and of terms at the time `start_s`, s since 1970.
inline std::vector<std::uint64_t> listExtremes(std::uint64_t start_s) {
  constexpr std::uint64_t kDay_s = 86'400;
  std::vector<std::uint64_t> extremes{0, 1, ~std::uint64_t{0}, std::uint64_t{1} << 62U};
  for (const unsigned bits : {31U, 32U, 62U, 63U}) {
    for (const std::uint64_t more : {~std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{1}})
      extremes.push_back((std::uint64_t{1} << bits) + more);
  }
  for (const std::uint64_t ahead_s :
       {std::uint64_t{0}, std::uint64_t{100}, kDay_s - 1, kDay_s, kDay_s + 1})
    extremes.push_back(start_s + ahead_s);
  return extremes;
}

/// Returns messages of every kind, signed by `rival`, each with the number `extreme` in one of its
/// places. Their terms are above those of origins that have started at `start_s`, s since 1970.
inline std::vector<std::vector<std::uint8_t>> listHostileMessages(SigningKey& rival,
                                                                  std::uint64_t start_s,
                                                                  std::uint64_t extreme) {
  constexpr std::uint64_t kRival = (std::uint64_t{9} << 32U) | 9;
  const Duration time(static_cast<std::int64_t>(extreme));
  RelayFrame early = makeFrame(1);
  early.media_time = MediaTime(time);
  const std::vector<RelayContent> contents{
      makeState(rival, kRival),
      makeFrame(extreme),
      makeFrame(1, static_cast<std::uint32_t>(extreme)),
      early,
      RelayPicture{extreme, MediaTime(time), makeFrame(1).delta},
      RelayPong{LocalTime(time), MediaTime(time), MediaTime(time)}};
  std::vector<std::vector<std::uint8_t>> messages;
  messages.reserve(3 * contents.size() + 1);
  for (const RelayContent& content : contents) {
    for (const RelayHead& head : {RelayHead{extreme, kRival, 1}, RelayHead{start_s, extreme, 1},
                                  RelayHead{start_s + 50, kRival, extreme}})
      messages.push_back(makeMessage(rival, head, content));
  }
  messages.push_back(makeMessage(rival, {extreme, extreme, extreme}, makeState(rival, extreme)));
  return messages;
}

}  // namespace hapticast::server
