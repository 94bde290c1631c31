// SPDX-License-Identifier: MIT
#include "server/http/http_server.hpp"

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/write.hpp>
#include <utility>

#include "server/http/http_response.hpp"
#include "server/stream/listener.hpp"

namespace hapticast::server {

namespace {
constexpr auto kCheckConnectionsEvery = std::chrono::milliseconds(250);  // chosen
constexpr auto kPauseOfAcceptor = std::chrono::milliseconds(200);        // chosen
// Chosen: more than a client sends before it reads the response.
constexpr int kMostDrainedChunks = 64;
}  // namespace

struct HttpServer::Connection {
  asio::ip::tcp::socket socket;
  LocalTime deadline;
  boost::beast::flat_buffer buffer{kMaxHead_bytes};  // a longer head is an error

  void close() {
    boost::system::error_code ignored;
    socket.close(ignored);
  }
};

HttpServer::HttpServer(asio::io_context& io, const Clock& clock, const Endpoint& address,
                       std::function<Metrics()> collect)
    : io_(io),
      clock_(clock),
      collect_(std::move(collect)),
      acceptor_(openPort(io, address, "--http")),
      pause_(io),
      timer_(io),
      address_(describeAddress(acceptor_, address)) {}

void HttpServer::start() {
  asio::co_spawn(
      io_, [this] { return acceptAll(); }, asio::detached);
  asio::co_spawn(
      io_, [this] { return closeLate(); }, asio::detached);
}

void HttpServer::stop() {
  asio::post(io_, [this] {
    boost::system::error_code ignored;
    acceptor_.close(ignored);
    for (const auto& each : connections_) each->close();
    pause_.cancel();
    timer_.cancel();
  });
}

asio::awaitable<void> HttpServer::acceptAll() {
  while (acceptor_.is_open()) {
    boost::system::error_code ec;
    auto socket = co_await acceptor_.async_accept(asio::redirect_error(asio::use_awaitable, ec));
    if (!acceptor_.is_open()) co_return;  // a connection at that moment ends with its socket
    if (!ec) {
      add(std::move(socket));
      co_await awaitTurn();
    } else {
      // For example out of file handles: an immediate retry would spin.
      pause_.expires_after(kPauseOfAcceptor);
      co_await pause_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    }
  }
}

void HttpServer::add(asio::ip::tcp::socket socket) {
  if (connections_.size() >= kMostConnections) {
    const auto oldest =
        std::min_element(connections_.begin(), connections_.end(),
                         [](const auto& a, const auto& b) { return a->deadline < b->deadline; });
    (*oldest)->close();
    connections_.erase(oldest);
  }
  auto connection =
      std::make_shared<Connection>(Connection{std::move(socket), clock_.now() + kTimeout});
  connections_.push_back(connection);
  asio::co_spawn(
      io_, [this, connection] { return serve(connection); }, asio::detached);
}

asio::awaitable<void> HttpServer::closeLate() {
  while (acceptor_.is_open()) {
    boost::system::error_code ec;
    timer_.expires_after(kCheckConnectionsEvery);
    co_await timer_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    const LocalTime now = clock_.now();
    for (const auto& each : connections_) {
      if (each->deadline <= now) each->close();
    }
  }
}

asio::awaitable<void> HttpServer::serve(std::shared_ptr<Connection> connection) {
  co_await answerAll(*connection);
  connection->close();
  std::erase(connections_, connection);
}

asio::awaitable<void> HttpServer::answerAll(Connection& connection) {
  for (std::size_t number = 1; number <= kMostRequests; ++number) {
    connection.deadline = clock_.now() + kTimeout;
    boost::system::error_code ec;
    const auto request = co_await awaitRequest(connection, ec);
    if (!request) co_return;
    HttpResponse response =
        respond(*request, ec, number < kMostRequests, [this] { return collectFreshMetrics(); });
    connection.deadline = clock_.now() + kTimeout;
    co_await boost::beast::http::async_write(connection.socket, response,
                                             asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
    if (!response.keep_alive()) co_return co_await finish(connection);
  }
}

asio::awaitable<std::optional<HttpRequest>> HttpServer::awaitRequest(
    Connection& connection, boost::system::error_code& error) {
  for (;;) {
    if (connection.buffer.size() > 0) co_await awaitTurn();
    if (auto request = readRequest(connection.buffer, error)) co_return request;
    const std::size_t room = connection.buffer.max_size() - connection.buffer.size();
    boost::system::error_code ec;
    const std::size_t size = co_await connection.socket.async_read_some(
        connection.buffer.prepare(room), asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return std::nullopt;
    connection.buffer.commit(size);
  }
}

asio::awaitable<void> HttpServer::awaitTurn() {
  const auto now = asio::steady_timer::clock_type::now();
  const auto turn = std::max(now, next_turn_);
  next_turn_ = turn + kTurnEvery;
  if (turn == now) co_return;
  asio::steady_timer timer(io_, turn);
  boost::system::error_code ec;
  co_await timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
}

asio::awaitable<void> HttpServer::finish(Connection& connection) {
  boost::system::error_code ec;
  connection.socket.shutdown(asio::socket_base::shutdown_send, ec);
  for (int i = 0; !ec && i < kMostDrainedChunks; ++i) {
    connection.buffer.clear();
    (void)co_await connection.socket.async_read_some(connection.buffer.prepare(kMaxHead_bytes),
                                                     asio::redirect_error(asio::use_awaitable, ec));
  }
}

Metrics HttpServer::collectFreshMetrics() {
  if (!collected_ || clock_.now() - collected_->now >= kFreshFor) collected_ = collect_();
  return *collected_;
}

}  // namespace hapticast::server
