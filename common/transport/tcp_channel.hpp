// SPDX-License-Identifier: MIT
// A channel over TCP: each payload with its length in front (framing.hpp).
#pragma once

#include <array>
#include <vector>

#include "common/transport/channel.hpp"

namespace hapticast {

class TcpChannel final : public Channel {
 public:
  /// Takes over a connected socket and asks it to send small messages at once.
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
  /// Reads once into chunk_; 0 bytes when the connection has ended.
  asio::awaitable<std::size_t> readSome();

  asio::ip::tcp::socket socket_;
  std::vector<std::uint8_t> chunk_;
  FrameReader reader_;
  LengthPrefix prefix_{};    // of the payload that is being written
  std::size_t written_ = 0;  // of prefix and payload, by writeNow()
};

}  // namespace hapticast
