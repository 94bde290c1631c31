// SPDX-License-Identifier: MIT
// Messages of Foxglove's WebSocket protocol, version 1 (docs.foxglove.dev). The server states its
// name and its channels as JSON. A watcher subscribes to channels, with a number of its own for
// each subscription. The server then sends each message of the channel as binary: opcode, number of
// the subscription, time, data. This server is read-only: it offers no other requests. Thread: any.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/recording/mcap_records.hpp"

namespace hapticast {

/// Name of the protocol in the WebSocket's handshake.
inline constexpr std::string_view kLiveProtocol = "foxglove.websocket.v1";
/// Largest message of a watcher, bytes. Chosen: a thousand subscriptions.
inline constexpr std::size_t kMostRequestBytes = 64U << 10U;

/// Returns the first message to a watcher, as JSON. `name`: of this program.
[[nodiscard]] std::string makeServerInfo(const std::string& name);
/// Returns the message that lists `channels`. The number of a channel is its place, from 1 on.
[[nodiscard]] std::string makeAdvertisement(const std::vector<McapChannel>& channels);
/// Returns a warning for the watcher's user.
[[nodiscard]] std::string makeWarning(const std::string& text);

/// Returns the head of a binary message with data. `time_ns`: time of the message.
[[nodiscard]] std::array<std::uint8_t, 13> makeDataHead(std::uint32_t subscription,
                                                        std::uint64_t time_ns);

/// One request of a watcher: subscriptions begin or end.
struct LiveRequest {
  struct Subscription {
    std::uint32_t number;
    std::uint32_t channel;
    bool operator==(const Subscription&) const = default;
  };
  std::vector<Subscription> begin;
  std::vector<std::uint32_t> end;
  bool operator==(const LiveRequest&) const = default;
};

/// Decodes a request of a watcher. Returns nullopt if `text` is none of the two requests.
[[nodiscard]] std::optional<LiveRequest> decodeLiveRequest(std::string_view text);

}  // namespace hapticast
