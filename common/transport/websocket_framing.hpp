// SPDX-License-Identifier: MIT
// The server's end of a WebSocket (RFC 6455, section 5) without its handshake. Each message is one
// binary message. The client's frames are masked, and a message may arrive in several of them. The
// server sends each message as one frame without a mask, so all viewers share its bytes. There is
// no compression. Of several pings only the newest is answered: its pong leaves in front of the
// next message. Thread: any; at most one at a time for each object.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/transport/framing.hpp"

namespace hapticast {

/// The framing of a WebSocket, for a server.
class WebSocketFraming final : public Framing {
 public:
  /// Largest number of frames of one message; a choice. A message of 64 KiB may arrive in pieces of
  /// 512 bytes. Smaller pieces would cost far more time than their bytes.
  static constexpr std::size_t kMostFragments = 128;

  explicit WebSocketFraming(std::size_t limit_bytes) : Framing(limit_bytes) {}

  void feed(std::span<const std::uint8_t> chunk) override;
  /// See Framing::next(). Also reads the pings, pongs and the close of the peer. The result is
  /// valid until the next call.
  [[nodiscard]] Result<std::optional<std::span<const std::uint8_t>>, WireError> next() override;
  void writePrefix(std::size_t payload_bytes, FramePrefix& out) override;
  [[nodiscard]] bool ended() const override { return ended_; }
  /// Returns a close frame. Its status is that of the error of next(), else 1000.
  [[nodiscard]] FramePrefix makeFarewell() const override;

 private:
  static constexpr std::size_t kMaskBytes = 4;
  static constexpr std::size_t kMostControlBytes = 125;

  /// The header of one frame.
  struct Header {
    std::uint8_t opcode = 0;
    bool final = false;
    std::size_t size = 0;  // of the header
    std::size_t payload = 0;
  };
  /// Returns the header at the begin of `bytes`, or nullopt if it is not complete.
  [[nodiscard]] Result<std::optional<Header>, WireError> readHeader(
      std::span<const std::uint8_t> bytes) const;
  /// Reads the length in a header of which at least two bytes have arrived.
  [[nodiscard]] static Result<std::optional<Header>, WireError> readLength(
      std::span<const std::uint8_t> bytes, Header header);
  /// Returns the error of a frame with `header` at this place, or nullopt.
  [[nodiscard]] std::optional<WireError> check(const Header& header) const;
  /// Stores the answer to a control frame.
  [[nodiscard]] std::optional<WireError> onControl(std::uint8_t opcode,
                                                   std::span<const std::uint8_t> payload);
  /// Stores the error for makeFarewell(), and returns it.
  WireError fail(WireError error);

  std::vector<std::uint8_t> buffer_;                    // bytes of the peer
  std::size_t begin_ = 0;                               // index of the first byte of the next frame
  std::vector<std::uint8_t> message_;                   // the fragments that have arrived
  std::size_t fragments_ = 0;                           // their number; 0: no message has begun
  bool whole_ = false;                                  // message_ is the last result of next()
  std::array<std::uint8_t, kMostControlBytes> ping_{};  // the newest ping's payload
  std::optional<std::size_t> ping_size_;                // nullopt: no ping waits for its pong
  bool ended_ = false;
  std::optional<WireError> error_;
};

}  // namespace hapticast
