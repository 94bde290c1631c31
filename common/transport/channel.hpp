// SPDX-License-Identifier: MIT
// One connection to a peer as whole messages: payloads go in and come out, and how they are framed
// on the way is the channel's own affair. Server and client speak to channels only; a further
// transport is one more class of this kind. Thread: the one that runs the channel's io_context.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "common/transport/asio.hpp"
#include "common/transport/framing.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

/// The bytes of one message (common/protocol/messages.hpp), without any framing.
using Payload = std::span<const std::uint8_t>;

/// The two hosts of a connection, unspecified where it has none.
struct Hosts {
  asio::ip::address peer;
  asio::ip::address local;
};

class Channel {
 public:
  virtual ~Channel() = default;

  /// The next payload, valid until the next read(); nullopt when the connection has ended
  /// (whyEnded()); kMalformed or kTooLarge when the peer's framing is wrong, after which no further
  /// payload comes. One read at a time.
  virtual asio::awaitable<Result<std::optional<Payload>, WireError>> read() = 0;
  /// Writes as much of a payload of 1..kMaxMessageBytes bytes as goes without waiting, and returns
  /// whether that is all of it. If it is not, write() of the same payload has to follow: it goes on
  /// where this stopped, and tells whether the connection has ended. Not during a write.
  [[nodiscard]] virtual bool writeNow(const SharedBytes& payload) noexcept = 0;
  /// Writes one payload; false when the connection has ended. One write at a time.
  virtual asio::awaitable<bool> write(SharedBytes payload) = 0;
  /// Reads and throws away what comes until the peer ends the connection or `most_bytes` have come.
  /// Closing a socket with unread bytes would reset the connection before the peer has read why.
  virtual asio::awaitable<void> drain(std::size_t most_bytes) = 0;
  /// Tells the peer that nothing more will be written.
  virtual void finishWriting() noexcept = 0;
  /// Whether the peer's side has taken all that was written: then close() leaves nothing behind.
  [[nodiscard]] virtual bool delivered() noexcept = 0;
  /// Ends the connection; what waits in read() and write() comes back. What was written still
  /// travels, for as long as the peer takes.
  virtual void close() noexcept = 0;
  /// Ends the connection and forgets what the peer has not taken: who does not read would keep it
  /// in the system's memory for minutes.
  virtual void abort() noexcept = 0;

  /// The longest payload that read() takes from now on.
  void setReadLimit(std::size_t bytes) { read_limit_bytes_ = bytes; }
  [[nodiscard]] const std::string& peer() const { return peer_; }  ///< address, for the log
  [[nodiscard]] const Hosts& hosts() const { return hosts_; }
  [[nodiscard]] const std::string& whyEnded() const { return why_ended_; }
  /// Bytes on the way so far, framing included; during a write they rise as the peer takes them.
  [[nodiscard]] std::uint64_t bytesRead() const { return bytes_read_; }
  [[nodiscard]] std::uint64_t bytesWritten() const { return bytes_written_; }

 protected:
  Channel(std::string peer, std::size_t read_limit_bytes)
      : peer_(std::move(peer)), read_limit_bytes_(read_limit_bytes) {}

  std::string peer_;
  Hosts hosts_;
  std::string why_ended_;
  std::size_t read_limit_bytes_;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t bytes_written_ = 0;
};

}  // namespace hapticast
