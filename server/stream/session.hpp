// SPDX-License-Identifier: MIT
// One viewer's connection: hello and welcome, pings, the queue of what is to be sent, and how it
// ends. Its coroutines own it; it never blocks and never grows. Thread: io.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "common/wire/asio.hpp"
#include "common/wire/messages.hpp"
#include "server/stream/send_queue.hpp"

namespace hapticast::server {

class Broadcaster;

class Session : public std::enable_shared_from_this<Session> {
 public:
  static constexpr std::size_t kMaxPongs = 16;  ///< pings answered at once
  static constexpr std::uint32_t kMaxMessagesPerSecond = 200;

  /// `broadcaster` outlives the session's coroutines.
  Session(asio::ip::tcp::socket socket, Broadcaster& broadcaster, std::uint32_t id);

  void start();
  void send(const EncodedFrame& frame);
  void send(const EncodedVideo& video);
  /// `other_picture`: what waits belongs to another workspace and is forgotten.
  void describe(const SharedBytes& description, bool other_picture);
  /// Tells the peer why, then closes; what still waits is forgotten.
  void close(const Error& why);
  /// Looks after the deadlines; called regularly.
  void check(LocalTime now);

  [[nodiscard]] bool welcomed() const { return hello_.has_value() && !closing_since_; }
  [[nodiscard]] bool wantsVideo() const { return welcomed() && hello_->wants_video; }
  [[nodiscard]] std::string label() const;  ///< for the log
  [[nodiscard]] const SendCounts& counts() const { return queue_.counts(); }

 private:
  asio::awaitable<void> readAll();
  asio::awaitable<void> writeAll();
  asio::awaitable<bool> writeBytes(SharedBytes bytes);
  void handleChunk(std::span<const std::uint8_t> chunk, FrameReader& reader);
  void handle(const Hello& hello);
  void handle(const Ping& ping);
  void handle(const Report& report);
  template <class Other>
  void handle(const Other& other);
  [[nodiscard]] bool withinRate();
  [[nodiscard]] SharedBytes nextBytes();
  void disconnect();

  asio::ip::tcp::socket socket_;
  asio::steady_timer wake_;  // the writer sleeps on it; cancelled when there is something to do
  Broadcaster& broadcaster_;
  std::uint32_t id_;
  std::string peer_;
  SendQueue queue_;
  std::deque<Pong> pongs_;  // t2 is filled in when one is sent
  std::optional<Hello> hello_;
  LocalTime started_;
  LocalTime heard_;                          // last message
  std::optional<LocalTime> write_progress_;  // set while a write is under way
  std::optional<LocalTime> closing_since_;
  LocalTime rate_since_;
  std::uint32_t rate_count_ = 0;
  std::size_t drained_bytes_ = 0;
};

}  // namespace hapticast::server
