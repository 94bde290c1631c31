// SPDX-License-Identifier: MIT
// Accepts viewers on ADDR:PORT and hands their connections to the broadcaster. Thread: io.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "common/wire/asio.hpp"
#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

/// What was given as address is none: wrong input, where other failures to listen are the
/// machine's.
class AddressError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Listener {
 public:
  /// `address` is ADDR:PORT, numeric, IPv6 in brackets; port 0 takes a free one. Throws
  /// AddressError or std::runtime_error with one line that names the address and what to do.
  Listener(asio::io_context& io, const std::string& address, Broadcaster& broadcaster);

  [[nodiscard]] std::uint16_t port() const { return port_; }
  /// No new connections from now on. Thread: any.
  void stop();

 private:
  asio::awaitable<void> acceptAll();

  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  Broadcaster& broadcaster_;
  std::uint16_t port_ = 0;
};

}  // namespace hapticast::server
