// SPDX-License-Identifier: MIT
// WebSocketFraming: however a client's stream is cut into chunks, the same messages come out, the
// same error or close ends it, and no message or answer is larger than allowed.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/transport/websocket_framing.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::websocket {
namespace {

constexpr std::size_t kLimit_bytes = 4096;

struct Outcome {
  std::vector<std::vector<std::uint8_t>> messages;
  std::optional<hapticast::ErrorCode> error;
  bool ended = false;
  std::vector<std::uint8_t> answer;    // in front of the next message
  std::vector<std::uint8_t> farewell;  // at the end
  bool operator==(const Outcome&) const = default;
};

/// Reads all whole messages that have arrived. Returns whether more may follow.
bool readAll(hapticast::WebSocketFraming& framing, Outcome& outcome) {
  for (;;) {
    const auto next = framing.next();
    if (!next.ok()) outcome.error = next.error().code;
    if (!next.ok()) return false;
    if (!next.value()) return !framing.ended();
    require(!next.value()->empty() && next.value()->size() <= kLimit_bytes);
    outcome.messages.emplace_back(next.value()->begin(), next.value()->end());
  }
}

Outcome read(std::span<const std::uint8_t> stream, std::size_t chunk) {
  hapticast::WebSocketFraming framing(kLimit_bytes);
  Outcome outcome;
  for (bool open = true; open && !stream.empty();) {
    const auto size = std::min(chunk, stream.size());
    framing.feed(stream.first(size));
    stream = stream.subspan(size);
    open = readAll(framing, outcome);
  }
  outcome.ended = framing.ended();
  const hapticast::FramePrefix farewell = framing.makeFarewell();
  outcome.farewell.assign(farewell.view().begin(), farewell.view().end());
  hapticast::FramePrefix prefix;
  framing.writePrefix(hapticast::kMaxMessageBytes, prefix);
  require(prefix.size >= 10 && prefix.size <= hapticast::FramePrefix::kMostBytes);
  outcome.answer.assign(prefix.view().begin(), prefix.view().end());
  return outcome;
}

}  // namespace

HAPTICAST_FUZZ_TARGET("websocket") {
  const std::span stream(data, size);
  const Outcome whole = read(stream, std::max<std::size_t>(size, 1));
  for (const std::size_t chunk : {1U, 3U, 7U}) require(read(stream, chunk) == whole);
  return 0;
}

}  // namespace hapticast::fuzz::websocket
