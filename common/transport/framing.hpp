// SPDX-License-Identifier: MIT
// Messages on a byte stream: a 4-byte little-endian length, then that many bytes (proto/README.md).
// Thread: one per FrameReader.
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
/// What a server accepts from a client, and what a client accepts before the welcome.
inline constexpr std::size_t kMaxSmallMessageBytes = 64U << 10U;

/// Bytes that are made once and shared by all who send them; immutable.
using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

using LengthPrefix = std::array<std::uint8_t, kPrefixBytes>;
/// What goes in front of a payload of so many bytes, 1..kMaxMessageBytes.
[[nodiscard]] LengthPrefix lengthPrefix(std::size_t payload_bytes);

/// Cuts a stream of arbitrary chunks into messages. Holds at most one message of the limit plus one
/// chunk.
class FrameReader {
 public:
  explicit FrameReader(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Takes bytes off the stream; invalidates what next() returned.
  void feed(std::span<const std::uint8_t> chunk);

  /// The next whole message (without prefix), nullopt when more bytes are needed, or kMalformed
  /// (length 0) or kTooLarge, which stays: the stream has lost its frame. Valid until the next
  /// feed().
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>, WireError> next();

  /// Another limit for the messages that follow.
  void setLimit(std::size_t limit_bytes) { limit_bytes_ = limit_bytes; }

 private:
  std::size_t limit_bytes_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;  // of what next() has not returned yet
};

}  // namespace hapticast
