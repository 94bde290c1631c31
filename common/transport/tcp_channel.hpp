// SPDX-License-Identifier: MIT
// Channel over TCP, with TLS or without it. A Framing separates the payloads. The end of a server
// decides on the first bytes of its client what the connection carries, and inside TLS decides
// again (first_bytes.hpp). So one port serves clients of every kind. Thread: the one that runs the
// channel's io_context.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/transport/channel.hpp"
#include "common/transport/first_bytes.hpp"
#include "common/transport/framing.hpp"
#include "common/transport/tls.hpp"

namespace hapticast {

/// The end of a connection that a channel is.
enum class ChannelEnd : std::uint8_t { kClient, kServer };

/// A channel over a connected TCP socket.
class TcpChannel final : public Channel {
 public:
  /// Becomes the owner of `socket`, which must be connected. Disables Nagle's algorithm
  /// (TCP_NODELAY), so that small payloads are sent at once. `read_limit_bytes` is the size of the
  /// longest payload that read() accepts.
  ///
  /// `tls`: this host's end of a TLS connection; null: plain TCP. On a server the channel becomes
  /// plain TCP if the client begins without TLS. It answers a request of HTTP with one sentence;
  /// read() then returns an error.
  TcpChannel(asio::ip::tcp::socket socket, std::size_t read_limit_bytes,
             std::unique_ptr<TlsEngine> tls = nullptr, ChannelEnd end = ChannelEnd::kClient);

  /// Completes the TLS handshake of a client's end. Returns the error in one line, or nullopt. Call
  /// it before the first read() and write().
  asio::awaitable<std::optional<Error>> completeHandshake();

  asio::awaitable<Result<std::optional<Payload>, WireError>> read() override;
  bool writeNow(const SharedBytes& payload, bool more_follows) noexcept override;
  asio::awaitable<bool> write(SharedBytes payload) override;
  asio::awaitable<void> drain(std::size_t most_bytes) override;
  void finishWriting() noexcept override;
  bool delivered() noexcept override;
  void close() noexcept override;
  void abort() noexcept override;
  [[nodiscard]] bool encrypted() const noexcept override { return tls_ && tls_->established(); }

 private:
  /// Decrypts `bytes` of the peer for the framing.
  [[nodiscard]] std::optional<Error> receive(std::span<const std::uint8_t> bytes);
  /// Passes bytes of the peer, without encryption, to the framing.
  void receivePlain(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool encrypt(const SharedBytes& payload);
  /// Answers a request of HTTP, as far as the system accepts the answer at once.
  void answerHttp() noexcept;
  /// Returns whether the connection carries no payloads to the peer.
  [[nodiscard]] bool isMute() const { return http_ || (outer_.undecided() && tls_ != nullptr); }
  /// Sends as much of the encrypted bytes as possible without waiting.
  void flushNow() noexcept;
  [[nodiscard]] asio::awaitable<bool> flush();
  /// Writes all of `bytes` and returns true; false if the connection has ended. bytesWritten()
  /// increases with the progress.
  [[nodiscard]] asio::awaitable<bool> writeAll(std::array<asio::const_buffer, 2> bytes);
  /// Reads bytes once into chunk_ and returns their number. Returns 0 at the end of the connection.
  asio::awaitable<std::size_t> readSome();

  asio::ip::tcp::socket socket_;
  std::vector<std::uint8_t> chunk_;
  std::unique_ptr<Framing> framing_;
  FramePrefix prefix_;       // of the payload that is being written
  std::size_t written_ = 0;  // bytes of prefix and payload written by writeNow()

  std::unique_ptr<TlsEngine> tls_;  // null: plain TCP
  FirstBytes outer_;                // of the connection
  FirstBytes inner_;                // the same, or those inside TLS
  bool http_ = false;               // the peer has sent a request of HTTP
  bool encrypted_ = false;          // writeNow() has encrypted the payload of the next write()
  bool flushing_ = false;
  std::vector<std::uint8_t> plain_;    // decrypted bytes
  std::vector<std::uint8_t> sending_;  // encrypted bytes that flush() sends
};

}  // namespace hapticast
