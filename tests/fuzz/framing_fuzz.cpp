// SPDX-License-Identifier: MIT
// LengthFraming: however a stream is cut into chunks, the same messages come out and the same error
// ends it.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "common/transport/framing.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::framing {
namespace {

struct Outcome {
  std::vector<std::vector<std::uint8_t>> messages;
  std::optional<hapticast::ErrorCode> error;
  bool operator==(const Outcome&) const = default;
};

Outcome read(std::span<const std::uint8_t> stream, std::size_t chunk) {
  hapticast::LengthFraming reader(4096);
  Outcome outcome;
  while (!stream.empty()) {
    const auto size = std::min(chunk, stream.size());
    reader.feed(stream.first(size));
    stream = stream.subspan(size);
    for (;;) {
      const auto next = reader.next();
      if (!next.ok()) {
        outcome.error = next.error().code;
        return outcome;
      }
      if (!next.value()) break;
      if (next.value()->empty() || next.value()->size() > 4096) std::abort();
      outcome.messages.emplace_back(next.value()->begin(), next.value()->end());
    }
  }
  return outcome;
}

}  // namespace

HAPTICAST_FUZZ_TARGET("framing") {
  const std::span stream(data, size);
  const Outcome whole = read(stream, std::max<std::size_t>(size, 1));
  for (const std::size_t chunk : {1U, 3U, 7U}) {
    if (read(stream, chunk) != whole) std::abort();
  }
  return 0;
}

}  // namespace hapticast::fuzz::framing
