// SPDX-License-Identifier: MIT
// Channel over TCP. Each payload has a length prefix (framing.hpp). Thread: the one that runs the
// channel's io_context.
#pragma once

#include <array>
#include <vector>

#include "common/transport/channel.hpp"

namespace hapticast {

/// A channel over a connected TCP socket.
class TcpChannel final : public Channel {
 public:
  /// Owns `socket` from now on, which must be connected. Disables Nagle's algorithm (TCP_NODELAY),
  /// so that small payloads are sent at once. `read_limit_bytes` is the size of the longest payload
  /// that read() accepts.
  TcpChannel(asio::ip::tcp::socket socket, std::size_t read_limit_bytes);

  asio::awaitable<Result<std::optional<Payload>, WireError>> read() override;
  bool writeNow(const SharedBytes& payload) noexcept override;
  asio::awaitable<bool> write(SharedBytes payload) override;
  asio::awaitable<void> drain(std::size_t most_bytes) override;
  void finishWriting() noexcept override;
  bool delivered() noexcept override;
  void close() noexcept override;
  void abort() noexcept override;

 private:
  /// Reads bytes once into chunk_ and returns their number. Returns 0 at the end of the connection.
  asio::awaitable<std::size_t> readSome();

  asio::ip::tcp::socket socket_;
  std::vector<std::uint8_t> chunk_;
  FrameReader reader_;
  LengthPrefix prefix_{};    // length prefix of the payload that is being written
  std::size_t written_ = 0;  // bytes of prefix and payload written by writeNow()
};

}  // namespace hapticast
