// SPDX-License-Identifier: MIT
// Framing: separates the messages on a stream of bytes. A prefix precedes each message. In
// LengthFraming it is the length of the message, 4 bytes in little-endian order (proto/README.md).
// websocket_framing.hpp has that of WebSockets. All framings share the bytes of the messages.
// Thread: any; at most one at a time for each object.
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

/// Bytes that precede a message on the connection, or that end it.
struct FramePrefix {
  /// A pong of 125 bytes with its header, and the header of a message (RFC 6455, section 5.2).
  static constexpr std::size_t kMostBytes = 137;
  std::array<std::uint8_t, kMostBytes> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> view() const { return std::span(bytes).first(size); }
  void add(std::uint8_t byte) { bytes[size++] = byte; }
};

/// Interface of a framing, for both directions of one connection.
class Framing {
 public:
  virtual ~Framing() = default;

  /// Adds the next bytes of the peer. The last result of next() is then invalid.
  virtual void feed(std::span<const std::uint8_t> chunk) = 0;
  /// Returns the next whole message without its prefix, valid until the next call of next() or
  /// feed(). Returns nullopt if more bytes are needed.
  ///
  /// Returns the error kMalformed for bytes that contain no message, and kTooLarge for a message
  /// above the limit. Close the connection then, because the begin of the next message is unknown.
  [[nodiscard]] virtual Result<std::optional<std::span<const std::uint8_t>>, WireError> next() = 0;
  /// Writes the prefix of the next message to the peer into `out`. The message has `payload_bytes`
  /// bytes, 1..kMaxMessageBytes. Call it once for each message: the prefix may also contain an
  /// answer to the peer.
  virtual void writePrefix(std::size_t payload_bytes, FramePrefix& out) = 0;
  /// Returns whether the peer has announced the end of the connection. next() then returns nullopt.
  [[nodiscard]] virtual bool ended() const { return false; }
  /// Returns the bytes that announce the end of this host's messages. They are empty if the framing
  /// has no such announcement.
  [[nodiscard]] virtual FramePrefix makeFarewell() const { return {}; }

  /// Sets the largest size of the messages that next() returns from now on.
  void setLimit(std::size_t limit_bytes) { limit_bytes_ = limit_bytes; }

 protected:
  explicit Framing(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}
  [[nodiscard]] std::size_t limitBytes() const { return limit_bytes_; }

 private:
  std::size_t limit_bytes_;
};

/// The framing of hapticast: a length before each message. The peer's bytes arrive in pieces of any
/// size. It stores at most one message of the largest allowed size plus one piece.
class LengthFraming final : public Framing {
 public:
  explicit LengthFraming(std::size_t limit_bytes) : Framing(limit_bytes) {}

  void feed(std::span<const std::uint8_t> chunk) override;
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>, WireError> next() override;
  void writePrefix(std::size_t payload_bytes, FramePrefix& out) override;

 private:
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;  // index of the first byte that next() has not returned
};

}  // namespace hapticast
