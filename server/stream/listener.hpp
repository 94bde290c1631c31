// SPDX-License-Identifier: MIT
// Accepts viewers on ADDR:PORT and hands their connections to the broadcaster. Thread: io.
#pragma once

#include <cstdint>
#include <string>

#include "common/endpoint.hpp"
#include "common/transport/asio.hpp"
#include "server/stream/address_error.hpp"
#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

class Listener {
 public:
  /// The host of `address` is numeric or localhost (127.0.0.1); port 0 takes a free one. Throws
  /// AddressError or std::runtime_error with one line that names the address and what to do.
  /// Who connects waits until start().
  Listener(asio::io_context& io, const Endpoint& address, Broadcaster& broadcaster);

  /// Lets them in. Thread: any, once.
  void start();
  /// Where it listens, with the port that was taken.
  [[nodiscard]] const Endpoint& address() const { return address_; }
  [[nodiscard]] asio::ip::tcp::endpoint endpoint() const { return acceptor_.local_endpoint(); }
  /// No new connections from now on. Thread: any.
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
