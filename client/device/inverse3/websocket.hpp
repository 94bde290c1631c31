// SPDX-License-Identifier: MIT
// A WebSocket connection with text messages (RFC 6455), for a service on this machine.
// Thread: one.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/time.hpp"

namespace hapticast::client {

class WebSocket {
 public:
  /// Connects to `host`:`port`. Throws std::runtime_error (one line).
  WebSocket(const std::string& host, const std::string& port);
  ~WebSocket();
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  /// Sends one text message. Throws std::runtime_error if the connection is lost.
  void send(const std::string& text);
  /// Returns the next message. Returns nullopt if none has arrived until `deadline`. Throws
  /// std::runtime_error if the connection is lost, or if a message is longer than 1 MiB.
  std::optional<std::string> receive(LocalTime deadline);

 private:
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

}  // namespace hapticast::client
