// SPDX-License-Identifier: MIT
// Channel: one connection to a peer that carries whole payloads; the implementation adds the
// framing.
// Server and client use channels only, so a further transport is one more implementation. Thread:
// the one that runs the channel's io_context.
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

/// Bytes of one message (common/protocol/messages.hpp), without framing.
using Payload = std::span<const std::uint8_t>;

/// The two hosts of a connection; unspecified if it has none.
struct Hosts {
  asio::ip::address peer;
  asio::ip::address local;
};

/// Interface of a connection.
class Channel {
 public:
  virtual ~Channel() = default;

  /// Returns the next payload, valid until the next read(); nullopt at the end of the connection
  /// (see whyEnded()). Returns kMalformed or kTooLarge for invalid framing; then no further payload
  /// follows. One read at a time.
  virtual asio::awaitable<Result<std::optional<Payload>, WireError>> read() = 0;
  /// Writes as much of a payload (1..kMaxMessageBytes bytes) as possible without waiting. Returns
  /// whether that is all of it. Not during a write.
  /// If not, write() of the same payload must follow: it writes the rest and reports the end of the
  /// connection.
  [[nodiscard]] virtual bool writeNow(const SharedBytes& payload) noexcept = 0;
  /// Writes one payload. Returns false if the connection has ended. One write at a time.
  virtual asio::awaitable<bool> write(SharedBytes payload) = 0;
  /// Reads and discards until the peer ends the connection or `most_bytes` are read. A close with
  /// unread bytes would reset the connection before the peer reads the last message.
  virtual asio::awaitable<void> drain(std::size_t most_bytes) = 0;
  /// Signals the peer that nothing more will be written.
  virtual void finishWriting() noexcept = 0;
  /// Returns whether the peer's system has acknowledged all bytes; then close() loses nothing.
  [[nodiscard]] virtual bool delivered() noexcept = 0;
  /// Ends the connection; pending read() and write() return. Bytes already written are still
  /// delivered, if the peer reads them.
  virtual void close() noexcept = 0;
  /// Ends the connection and discards undelivered bytes, which a peer that does not read would hold
  /// in the system's memory for minutes.
  virtual void abort() noexcept = 0;

  /// Sets the longest payload that read() accepts from now on.
  void setReadLimit(std::size_t bytes) { read_limit_bytes_ = bytes; }
  [[nodiscard]] const std::string& peer() const { return peer_; }  ///< address, for the log
  /// Returns the hosts of both ends.
  [[nodiscard]] const Hosts& hosts() const { return hosts_; }
  /// Returns the cause of the connection's end.
  [[nodiscard]] const std::string& whyEnded() const { return why_ended_; }
  /// Return the transferred bytes, framing included; during a write they increase with its
  /// progress.
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
