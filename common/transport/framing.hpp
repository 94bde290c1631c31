// SPDX-License-Identifier: MIT
// Framing: separates the messages on a stream of bytes. A prefix with the length of the message, 4
// bytes in little-endian order, precedes each message (proto/README.md). Thread: any; at most one
// at a time for each FrameReader.
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
/// Largest size of a small message. A server accepts only small messages from its clients. A client
/// accepts only small messages until the server's welcome has arrived. After that it accepts
/// messages of kMaxMessageBytes.
inline constexpr std::size_t kMaxSmallMessageBytes = 64U << 10U;

/// Bytes that do not change, and that several senders share.
using SharedBytes = std::shared_ptr<const std::vector<std::uint8_t>>;

using LengthPrefix = std::array<std::uint8_t, kPrefixBytes>;
/// Returns the length prefix of a payload of `payload_bytes` bytes, 1..kMaxMessageBytes.
[[nodiscard]] LengthPrefix lengthPrefix(std::size_t payload_bytes);

/// Finds the messages in a stream of bytes, which arrives in pieces of any size. It stores at most
/// one message of the largest allowed size plus one piece.
class FrameReader {
 public:
  explicit FrameReader(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// Adds the next bytes of the stream. The last result of next() is then invalid.
  void feed(std::span<const std::uint8_t> chunk);

  /// Returns the next whole message without its prefix, valid until the next feed(). Returns
  /// nullopt if more bytes are needed.
  ///
  /// Returns the error kMalformed for a length of 0, and kTooLarge for a length above the limit.
  /// All further calls then return the same error, because the begin of the next message is
  /// unknown.
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>, WireError> next();

  /// Sets the largest size of the messages from now on.
  void setLimit(std::size_t limit_bytes) { limit_bytes_ = limit_bytes; }

 private:
  std::size_t limit_bytes_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;  // index of the first byte that next() has not returned
};

}  // namespace hapticast
