// SPDX-License-Identifier: MIT
// Walks the fields of a protobuf message without parsing it, so that repeated messages can be
// counted before anything is allocated for them (an empty one costs 2 bytes on the wire and 150 in
// memory). It reads tags and skips unknown fields and groups with protobuf's own code, so that it
// goes at least as far as the parser does. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hapticast {

/// The contents of the length-delimited fields numbered `field`, at most `limit` of them (nullopt:
/// more). Stops at the first byte that makes no sense: the parser refuses it, too. Requires at most
/// kMaxMessageBytes.
[[nodiscard]] std::optional<std::vector<std::span<const std::uint8_t>>> submessages(
    std::span<const std::uint8_t> message, std::uint32_t field, std::size_t limit);

}  // namespace hapticast
