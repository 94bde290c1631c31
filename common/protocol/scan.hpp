// SPDX-License-Identifier: MIT
// Scanner of a protobuf message. It counts repeated submessages before the parser allocates memory
// for them. An empty submessage needs 2 bytes in the message, but 150 in memory. The scanner reads
// tags and skips unknown fields and groups with protobuf's own code. So it finds every submessage
// that the parser would find. Thread: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hapticast {

/// Returns the contents of the length-delimited fields numbered `field`; nullopt if there are more
/// than `limit`. Stops at the first invalid byte, which the parser rejects too. Requires at most
/// kMaxMessageBytes.
[[nodiscard]] std::optional<std::vector<std::span<const std::uint8_t>>> submessages(
    std::span<const std::uint8_t> message, std::uint32_t field, std::size_t limit);

}  // namespace hapticast
