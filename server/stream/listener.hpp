// SPDX-License-Identifier: MIT
// TCP acceptor on ADDR:PORT: passes new connections to the broadcaster. Thread: io.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "common/endpoint.hpp"
#include "common/transport/asio.hpp"
#include "server/stream/broadcaster.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

// Limit of open files (RLIMIT_NOFILE): each connection is an open file. Thread: main.

/// Raises this process's limit of open files if `viewers` need it, as far as the system allows.
/// Returns how many viewers fit: `viewers`, or fewer after one log line. Thread: main, before the
/// first connection.
std::size_t raiseFileLimit(std::size_t viewers);

/// Accepts viewers.
class Listener {
 public:
  /// Binds `address` and listens; connections wait until start(). Its host is numeric or localhost
  /// (127.0.0.1); port 0 selects a free port.
  /// Throws AddressError or std::runtime_error with one line that states the address and the
  /// remedy.
  Listener(asio::io_context& io, const Endpoint& address, Broadcaster& broadcaster);

  /// Starts to accept connections. Call once. Thread: any.
  void start();
  /// Returns the address with the actual port.
  [[nodiscard]] const Endpoint& address() const { return address_; }
  [[nodiscard]] asio::ip::tcp::endpoint endpoint() const { return acceptor_.local_endpoint(); }
  /// Stops accepting. Thread: any.
  void stop();

 private:
  asio::awaitable<void> acceptAll();
  void accept(asio::ip::tcp::socket socket);

  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  Broadcaster& broadcaster_;
  Endpoint address_;
};

}  // namespace hapticast::server
