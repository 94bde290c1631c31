// SPDX-License-Identifier: MIT
// Accepts TCP connections of viewers and browsers on ADDR:PORT and passes them to the broadcaster.
// Thread: the network's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/endpoint.hpp"
#include "common/transport/asio.hpp"
#include "common/transport/http_responder.hpp"
#include "common/transport/tcp_port.hpp"
#include "common/transport/tls.hpp"
#include "server/stream/broadcaster.hpp"
#include "server/stream/stream_settings.hpp"

namespace hapticast::server {

/// Raises this process's limit of open files, if `viewers` viewers need more and the system allows
/// it. `pending`: largest number of connections that are no viewers. Returns how many viewers the
/// limit then allows, at most `viewers`. If it allows fewer, logs that in one line. Thread: main,
/// before the first connection. Each connection is an open file (RLIMIT_NOFILE).
std::size_t raiseFileLimit(std::size_t viewers, std::size_t pending = Broadcaster::kMaxPending);

/// Raises this process's limit of open files by up to `wanted`, beside `used` connections. Returns
/// how many of them the limit then allows. Thread: main, after raiseFileLimit().
std::size_t raiseSpareFiles(std::size_t wanted, std::size_t used);

/// Accepts the connections of viewers.
class Listener {
 public:
  /// Opens the port of `address` as openPort() does; connections wait until start(). `tls`:
  /// certificate of the server; nullopt: plain TCP only. With a certificate, each connection uses
  /// TLS if its client begins with TLS. `responder` answers requests of HTTP; it must outlive all
  /// connections. Null: the answer is one sentence.
  Listener(asio::io_context& io, const Endpoint& address, Broadcaster& broadcaster,
           std::optional<TlsContext> tls = std::nullopt, HttpResponder* responder = nullptr);

  /// Starts to accept connections. Call once. Thread: any.
  void start();
  /// Returns the address at which viewers connect, with the actual port.
  [[nodiscard]] const Endpoint& address() const { return address_; }
  [[nodiscard]] asio::ip::tcp::endpoint endpoint() const { return acceptor_.local_endpoint(); }
  /// Replaces the certificate for later connections. Thread: any.
  void setTls(TlsContext tls);
  /// Stops accepting connections. Thread: any.
  void stop();

 private:
  asio::awaitable<void> acceptAll();
  void accept(asio::ip::tcp::socket socket);

  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  Broadcaster& broadcaster_;
  Endpoint address_;
  std::optional<TlsContext> tls_;
  HttpResponder* responder_;
};

}  // namespace hapticast::server
