// SPDX-License-Identifier: MIT
// HTTP port for operators (--http): /metrics, /health and /status.json. It changes no state of the
// server. It shares the network thread with the viewers, so connections, requests and times are
// limited. Thread: the network's, except for functions with "Thread: any".
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/endpoint.hpp"
#include "common/time.hpp"
#include "common/transport/asio.hpp"
#include "server/http/http_response.hpp"
#include "server/http/metrics.hpp"

namespace hapticast::server {

/// Listens on one port and answers requests.
class HttpServer {
 public:
  /// Largest number of connections that have sent something. One more connection replaces the one
  /// that has waited longest for its client. If all wait for their turn, it replaces the one with
  /// the most answers; if none has an answer, the new one is closed.
  static constexpr std::size_t kMostConnections = 16;
  /// Largest number of connections that have sent nothing yet. One more replaces the oldest. A
  /// flood of them closes no other connection.
  static constexpr std::size_t kMostSilent = 128;
  /// Largest number of connections that are accepted at once, and least time until the next ones.
  /// So a flood of connections can use only a bounded share of the network thread's time (3,000
  /// connections a second cost an eighth of a core).
  static constexpr int kMostAccepted = 32;
  static constexpr Duration kAcceptEvery = std::chrono::milliseconds(5);
  /// Number of requests after which a connection is closed.
  static constexpr std::size_t kMostRequests = 100;
  /// Longest time in which a whole request must arrive, and in which its response must be sent.
  static constexpr Duration kTimeout = std::chrono::seconds(5);
  /// Least time between two turns. A turn is the parsing of bytes with the response. So a flood of
  /// requests can use only a bounded share of the network thread's time.
  static constexpr Duration kTurnEvery = std::chrono::milliseconds(5);
  /// Largest age of figures that a response may reuse. Their collection costs time for each viewer.
  static constexpr Duration kFreshFor = std::chrono::milliseconds(100);

  /// Opens the port of `address` as openPort() does. `host_names`: the names of this server in
  /// requests (isOwnHost()). `collect` returns the present figures; thread: the network's. One
  /// thread runs `io`; it must end before this object's destruction. `clock` must outlive this
  /// object.
  HttpServer(asio::io_context& io, const Clock& clock, const Endpoint& address,
             std::vector<std::string> host_names, std::function<Metrics()> collect);

  /// Starts to accept connections. Call once. Thread: any.
  void start();
  /// Closes the port and all connections. Thread: any.
  void stop();
  /// Returns the address of the port, with its actual number.
  [[nodiscard]] const Endpoint& address() const { return address_; }

 private:
  struct Connection;
  using Connections = std::vector<std::shared_ptr<Connection>>;

  asio::awaitable<void> acceptAll();
  asio::awaitable<void> closeLate();
  asio::awaitable<void> serve(std::shared_ptr<Connection> connection);
  /// Answers requests until the connection has to end.
  asio::awaitable<void> answerAll(const std::shared_ptr<Connection>& connection);
  /// Returns the next request, or any request with `error`; nullopt at the end of the connection.
  asio::awaitable<std::optional<HttpRequest>> awaitRequest(
      const std::shared_ptr<Connection>& connection, boost::system::error_code& error);
  /// Shuts down the sending side, then reads the bytes that the client still sends. A close with
  /// unread bytes would reset the connection, and the client could lose the response.
  asio::awaitable<void> finish(Connection& connection);
  /// Begins to serve `socket`, unless its client has left already.
  void add(asio::ip::tcp::socket socket);
  /// Closes a connection if there are too many for one more that has sent nothing (`silent`), or
  /// for one more that has sent something. Returns false if none may be closed.
  [[nodiscard]] bool makeRoom(bool silent);
  /// Waits for the next turn. The connection with the fewest answers is the next one. Returns false
  /// if the connection was closed meanwhile; this costs no turn.
  asio::awaitable<bool> awaitTurn(std::shared_ptr<Connection> connection);
  [[nodiscard]] Metrics collectFreshMetrics();

  asio::io_context& io_;
  const Clock& clock_;
  std::function<Metrics()> collect_;
  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer pause_;  // after an error of the acceptor
  asio::steady_timer timer_;
  asio::steady_timer::time_point next_turn_{};
  Endpoint address_;
  std::vector<std::string> host_names_;
  Connections connections_;
  Connections waiting_;  // for their turn, in order
  std::optional<Metrics> collected_;
};

}  // namespace hapticast::server
