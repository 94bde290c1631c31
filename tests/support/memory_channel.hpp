// SPDX-License-Identifier: MIT
// Two ends of a connection in memory: the smallest transport there is. Whole payloads change hands,
// nothing is framed. Thread: the one that runs the io_context.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/transport/channel.hpp"

namespace hapticast::testing {

class MemoryChannel final : public Channel {
 public:
  /// Both ends; each takes payloads of at most `limit_bytes`.
  static std::pair<std::unique_ptr<MemoryChannel>, std::unique_ptr<MemoryChannel>> pair(
      asio::io_context& io, std::size_t limit_bytes) {
    auto there = std::make_shared<Transport>(io), back = std::make_shared<Transport>(io);
    return {std::make_unique<MemoryChannel>(there, back, limit_bytes),
            std::make_unique<MemoryChannel>(back, there, limit_bytes)};
  }

  asio::awaitable<Result<std::optional<Payload>, WireError>> read() override {
    while (in_->waiting.empty() && !in_->ended) co_await in_->wait();
    if (in_->waiting.empty()) {
      why_ended_ = "the other end has closed";
      co_return std::optional<Payload>();
    }
    current_ = std::move(in_->waiting.front());
    in_->waiting.pop_front();
    bytes_read_ += current_->size();
    if (current_->size() > read_limit_bytes_)
      co_return WireError{ErrorCode::kTooLarge, "a payload above the limit"};
    co_return std::optional<Payload>(*current_);
  }
  // Without memory a test may end.
  // NOLINTNEXTLINE(bugprone-exception-escape)
  bool writeNow(const SharedBytes& payload, bool /*more_follows*/) noexcept override {
    if (out_->ended) return false;
    bytes_written_ += payload->size();
    out_->waiting.push_back(payload);
    out_->changed.cancel();
    return true;
  }
  asio::awaitable<bool> write(SharedBytes payload) override { co_return writeNow(payload, false); }
  asio::awaitable<void> drain(std::size_t most_bytes) override {
    for (std::size_t drained = 0; drained <= most_bytes && !(in_->waiting.empty() && in_->ended);) {
      if (in_->waiting.empty()) {
        co_await in_->wait();
        continue;
      }
      drained += in_->waiting.front()->size();
      in_->waiting.pop_front();
    }
  }
  /// Passes for an encrypted connection between the hosts `hosts`, as TLS is. `peer`: address of
  /// the other end.
  void pretendTls(const Hosts& hosts, std::string peer) {
    hosts_ = hosts;
    peer_ = std::move(peer);
    encrypted_ = true;
  }
  bool encrypted() const noexcept override { return encrypted_; }
  asio::awaitable<void> finishWriting() override {
    out_->end();
    co_return;
  }
  std::size_t undeliveredBytes() noexcept override { return 0; }
  void close() noexcept override {
    in_->end();
    out_->end();
  }
  void abort() noexcept override { close(); }

  /// One direction.
  struct Transport {
    explicit Transport(asio::io_context& io) : changed(io) {}
    asio::awaitable<void> wait() {
      boost::system::error_code ec;
      changed.expires_at(asio::steady_timer::time_point::max());
      co_await changed.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    }
    void end() noexcept {
      ended = true;
      boost::system::error_code ec;
      changed.cancel(ec);
    }
    std::deque<SharedBytes> waiting;
    bool ended = false;
    asio::steady_timer changed;
  };
  MemoryChannel(std::shared_ptr<Transport> out, std::shared_ptr<Transport> in,
                std::size_t limit_bytes)
      : Channel("memory", limit_bytes), out_(std::move(out)), in_(std::move(in)) {}

 private:
  std::shared_ptr<Transport> out_, in_;
  SharedBytes current_;
  bool encrypted_ = false;
};

}  // namespace hapticast::testing
