// SPDX-License-Identifier: MIT
// Message framing on a byte stream: a 4-byte little-endian length, then the message
// (proto/README.md). Thread: one for each FrameReader.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

inline constexpr std::size_t kPrefixBytes = 4;
inline constexpr std::size_t kMaxMessageBytes = 8U << 20U;
/// Limit of a server for messages from clients, and of a client before the welcome.
inline constexpr std::size_t kMaxSmallMessageBytes = 64U << 10U;

/// Immutable bytes that all senders share.
using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

using LengthPrefix = std::array<std::uint8_t, kPrefixBytes>;
/// Returns the prefix of a payload of 1..kMaxMessageBytes bytes.
[[nodiscard]] LengthPrefix lengthPrefix(std::size_t payload_bytes);

/// Splits a stream of arbitrary chunks into messages. Buffers at most one message of the limit plus
/// one chunk.
class FrameReader {
 public:
  explicit FrameReader(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Adds bytes of the stream; invalidates the last result of next().
  void feed(std::span<const std::uint8_t> chunk);

  /// Returns the next whole message (without prefix), valid until the next feed(); nullopt if more
  /// bytes are needed. Returns kMalformed (length 0) or kTooLarge, then for ever: the message
  /// boundaries are lost.
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>, WireError> next();

  /// Sets the limit for the following messages.
  void setLimit(std::size_t limit_bytes) { limit_bytes_ = limit_bytes; }

 private:
  std::size_t limit_bytes_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;  // first byte that next() has not returned
};

}  // namespace hapticast
