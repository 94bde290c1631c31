// SPDX-License-Identifier: MIT
// Channel: a connection to a peer that carries whole payloads. A payload is the bytes of one
// message. The implementation separates the payloads on the connection.
//
// Server and client use only this interface. So a new transport needs only one more implementation.
// Thread: the one that runs the channel's io_context.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "common/time.hpp"
#include "common/transport/asio.hpp"
#include "common/transport/framing.hpp"
#include "common/wire_error.hpp"

namespace hapticast {

/// Bytes of one message (common/protocol/messages.hpp), without framing.
using Payload = std::span<const std::uint8_t>;

/// Addresses of the two hosts of a connection. They are unspecified if the channel has no
/// addresses.
struct Hosts {
  asio::ip::address peer;
  asio::ip::address local;
};

/// What a connection carries.
enum class Carrier : std::uint8_t {
  kMessages,   ///< messages with a length prefix
  kHttp,       ///< one request of HTTP and its answer; no payloads
  kWebSocket,  ///< messages in a WebSocket
};

/// Interface of a connection.
class Channel {
 public:
  virtual ~Channel() = default;

  /// Returns the next payload, which is valid until the next read(). Returns nullopt at the end of
  /// the connection (whyEnded()), and when a request of HTTP has arrived: carrier() is then kHttp,
  /// and answer() follows. Returns an error if the peer's bytes contain no valid payload
  /// (kMalformed), or one above the read limit (kTooLarge). After an error no further payload
  /// follows. Only one read may run at a time.
  virtual asio::awaitable<Result<std::optional<Payload>, WireError>> read() = 0;
  /// Writes as much of a payload (1..kMaxMessageBytes bytes) as possible without waiting. Returns
  /// true if it has written all of it. Do not call it while write() runs.
  ///
  /// If it returns false, the caller must call write() with the same payload. That call writes the
  /// rest, and its result states whether the connection has ended. `more_follows`: another payload
  /// follows at once, so both may leave together.
  [[nodiscard]] virtual bool writeNow(const SharedBytes& payload, bool more_follows) noexcept = 0;
  /// Writes one payload and returns true. Returns false if the connection has ended. Only one write
  /// may run at a time.
  virtual asio::awaitable<bool> write(SharedBytes payload) = 0;
  /// Sends the answer to the request that read() has received, then informs the peer that nothing
  /// follows. Ends early if the connection ends. Requires carrier() kHttp after read().
  virtual asio::awaitable<void> answer() { co_return; }
  /// Reads and discards bytes until the peer ends the connection, or until more than `most_bytes`
  /// are read. Call it before close(). A close with unread bytes would reset the connection before
  /// the peer reads the last message.
  virtual asio::awaitable<void> drain(std::size_t most_bytes) = 0;
  /// Informs the peer that no more payloads follow. Do not call it while write() runs.
  virtual asio::awaitable<void> finishWriting() = 0;
  /// Returns the number of written bytes that the peer's system has not acknowledged. At 0 close()
  /// loses nothing.
  [[nodiscard]] virtual std::size_t undeliveredBytes() noexcept = 0;
  /// Returns how long the last of `bytes` more takes to leave the link, by the present figures of
  /// the connection. 0: unknown, or not at all.
  [[nodiscard]] virtual Duration estimateDelay(std::size_t /*bytes*/) noexcept {
    return Duration{0};
  }
  /// Ends the connection. A running read() or write() returns. The system still delivers bytes that
  /// are already written, if the peer reads them.
  virtual void close() noexcept = 0;
  /// Ends the connection and discards undelivered bytes. If the peer does not read, the system
  /// would otherwise store them for minutes.
  virtual void abort() noexcept = 0;

  /// Returns whether the connection is encrypted (TLS). The result is valid after the first
  /// payload.
  [[nodiscard]] virtual bool encrypted() const noexcept { return false; }
  /// Returns what the connection carries. The result is valid after the first result of read().
  [[nodiscard]] virtual Carrier carrier() const noexcept { return Carrier::kMessages; }
  /// Returns whether the peer is surely a program of this machine. A connection from this machine
  /// may be that of a proxy, which forwards another machine's bytes.
  [[nodiscard]] virtual bool ofThisMachine() const noexcept { return hosts_.peer.is_loopback(); }

  /// Sets the size of the longest payload that read() accepts from now on.
  void setReadLimit(std::size_t bytes) { read_limit_bytes_ = bytes; }
  /// Address of the peer, for the log.
  [[nodiscard]] const std::string& peer() const { return peer_; }
  /// Returns the addresses of both hosts.
  [[nodiscard]] const Hosts& hosts() const { return hosts_; }
  /// Returns the reason why the connection has ended.
  [[nodiscard]] const std::string& whyEnded() const { return why_ended_; }
  /// Returns what is wrong with a request of HTTP, in one line. It is empty if nothing is.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Returns whether the connection has ended because this host does not trust its peer. whyEnded()
  /// is the reason.
  [[nodiscard]] bool untrusted() const { return untrusted_; }
  /// Return the number of transferred bytes, including the framing. During a write the number
  /// increases with its progress.
  [[nodiscard]] std::uint64_t bytesRead() const { return bytes_read_; }
  [[nodiscard]] std::uint64_t bytesWritten() const { return bytes_written_; }

 protected:
  Channel(std::string peer, std::size_t read_limit_bytes)
      : peer_(std::move(peer)), read_limit_bytes_(read_limit_bytes) {}

  std::string peer_;
  Hosts hosts_;
  std::string why_ended_;
  std::string problem_;
  bool untrusted_ = false;
  std::size_t read_limit_bytes_;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t bytes_written_ = 0;
};

}  // namespace hapticast
