// SPDX-License-Identifier: MIT
// Channel over TCP, with TLS or without it. A Framing separates the payloads. The end of a server
// decides on the first bytes of its client what the connection carries, and inside TLS decides
// again (first_bytes.hpp). So one port serves clients of every kind. A request of HTTP gets its
// answer from an HttpResponder, which may turn the connection into a WebSocket. Thread: the one
// that runs the channel's io_context.
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
#include "common/transport/http_responder.hpp"
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
  /// plain TCP if the client begins without TLS. `responder` answers requests of HTTP on a server;
  /// it must outlive the channel. Null: the answer is one sentence.
  TcpChannel(asio::ip::tcp::socket socket, std::size_t read_limit_bytes,
             std::unique_ptr<TlsEngine> tls = nullptr, ChannelEnd end = ChannelEnd::kClient,
             HttpResponder* responder = nullptr);

  /// Completes the TLS handshake of a client's end. Returns the error in one line, or nullopt. Call
  /// it before the first read() and write().
  asio::awaitable<std::optional<Error>> completeHandshake();

  asio::awaitable<Result<std::optional<Payload>, WireError>> read() override;
  bool writeNow(const SharedBytes& payload, bool more_follows) noexcept override;
  asio::awaitable<bool> write(SharedBytes payload) override;
  asio::awaitable<void> answer() override;
  asio::awaitable<void> drain(std::size_t most_bytes) override;
  asio::awaitable<void> finishWriting() override;
  std::size_t undeliveredBytes() noexcept override;
  /// Computes the delay from TCP's own figures (TCP_INFO). Behind a proxy they are the proxy's.
  [[nodiscard]] Duration estimateDelay(std::size_t bytes) noexcept override;
  void close() noexcept override;
  void abort() noexcept override;
  [[nodiscard]] bool encrypted() const noexcept override { return tls_ && tls_->established(); }
  [[nodiscard]] Carrier carrier() const noexcept override { return carrier_; }
  [[nodiscard]] bool ofThisMachine() const noexcept override {
    return Channel::ofThisMachine() && (carrier_ != Carrier::kWebSocket || for_this_machine_);
  }

 private:
  /// Decrypts `bytes` of the peer for the framing.
  [[nodiscard]] std::optional<Error> receive(std::span<const std::uint8_t> bytes);
  /// Passes bytes of the peer, without encryption, to the framing or to collectHead().
  void receivePlain(std::span<const std::uint8_t> bytes);
  /// Adds bytes to the head of a request. Sets answer_ once it is complete.
  void collectHead(std::span<const std::uint8_t> bytes);
  /// Turns the connection into a WebSocket and returns true, if answer_ is such an answer.
  asio::awaitable<bool> upgrade();
  [[nodiscard]] bool encrypt(const SharedBytes& payload);
  /// Returns whether the connection carries no payloads to the peer.
  [[nodiscard]] bool isMute() const {
    return carrier_ == Carrier::kHttp || (outer_.undecided() && tls_ != nullptr);
  }
  /// Sends as much of the encrypted bytes as possible without waiting.
  void flushNow() noexcept;
  [[nodiscard]] asio::awaitable<bool> flush();
  /// Writes bytes that are no payload, with encryption if the connection has it. Returns false if
  /// the connection has ended.
  [[nodiscard]] asio::awaitable<bool> writeBytes(std::array<asio::const_buffer, 2> parts);
  /// Writes all of `bytes` and returns true; false if the connection has ended. bytesWritten()
  /// increases with the progress.
  [[nodiscard]] asio::awaitable<bool> writeAll(std::array<asio::const_buffer, 2> bytes);
  /// Reads bytes once into chunk_ and returns their number. Returns 0 at the end of the connection.
  asio::awaitable<std::size_t> readSome();

  asio::ip::tcp::socket socket_;
  std::vector<std::uint8_t> chunk_;
  std::unique_ptr<Framing> framing_;
  FramePrefix prefix_;       // of the payload that is being written; empty: none is
  std::size_t written_ = 0;  // bytes of prefix and payload written by writeNow()

  std::unique_ptr<TlsEngine> tls_;  // null: plain TCP
  FirstBytes outer_;                // of the connection
  FirstBytes inner_;                // the same, or those inside TLS
  HttpResponder* responder_;        // null: one sentence answers requests
  Carrier carrier_ = Carrier::kMessages;
  bool for_this_machine_ = false;     // see HttpAnswer
  bool finished_ = false;             // finishWriting() was called
  HttpHead head_;                     // of a request
  std::optional<HttpAnswer> answer_;  // that was not sent yet
  bool encrypted_ = false;            // writeNow() has encrypted the payload of the next write()
  bool flushing_ = false;
  std::vector<std::uint8_t> plain_;    // decrypted bytes
  std::vector<std::uint8_t> sending_;  // encrypted bytes that flush() sends
};

}  // namespace hapticast
