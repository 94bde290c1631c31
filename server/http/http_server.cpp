// SPDX-License-Identifier: MIT
#include "server/http/http_server.hpp"

#include <algorithm>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/write.hpp>
#include <cstddef>
#include <tuple>
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
  asio::steady_timer turn{socket.get_executor()};    // wakes the connection for its turn
  bool silent = true;                                // it has sent nothing yet
  bool waits = false;                                // for its turn, with bytes in the buffer
  std::size_t answered = 0;                          // requests
  boost::beast::flat_buffer buffer{kMaxHead_bytes};  // a longer head is an error

  void close() {
    boost::system::error_code ignored;
    socket.close(ignored);
    turn.cancel();
  }
  /// Reads what has arrived, without waiting. Returns false if the client has left.
  bool readNow() {
    boost::system::error_code ec;
    socket.non_blocking(true, ec);
    const std::size_t size = socket.read_some(buffer.prepare(buffer.max_size()), ec);
    buffer.commit(size);
    silent = size == 0;
    waits = !silent;
    return !ec || ec == asio::error::would_block;
  }
};

HttpServer::HttpServer(asio::io_context& io, const Clock& clock, const Endpoint& address,
                       std::vector<std::string> host_names, std::function<Metrics()> collect)
    : io_(io),
      clock_(clock),
      collect_(std::move(collect)),
      acceptor_(openPort(io, address, "--http")),
      pause_(io),
      timer_(io),
      address_(describeAddress(acceptor_, address)),
      host_names_(std::move(host_names)) {
  acceptor_.non_blocking(true);
}

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
    co_await acceptor_.async_wait(asio::socket_base::wait_read,
                                  asio::redirect_error(asio::use_awaitable, ec));
    for (int i = 0; !ec && i < kMostAccepted; ++i) {
      asio::ip::tcp::socket socket = acceptor_.accept(ec);
      if (!ec) add(std::move(socket));
    }
    if (!acceptor_.is_open()) co_return;
    // After an error, for example out of file handles, an early retry fails again.
    const bool failed = ec && ec != asio::error::would_block;
    pause_.expires_after(failed ? kPauseOfAcceptor : kAcceptEvery);
    co_await pause_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
}

void HttpServer::add(asio::ip::tcp::socket socket) {
  auto connection =
      std::make_shared<Connection>(Connection{std::move(socket), clock_.now() + kTimeout});
  if (!connection->readNow() || !makeRoom(connection->silent)) return;
  connections_.push_back(connection);
  asio::co_spawn(
      io_, [this, connection] { return serve(connection); }, asio::detached);
}

bool HttpServer::makeRoom(bool silent) {
  // Those that wait for their turn leave last, the one with the most answers first.
  const auto rank = [](const Connection& each) {
    return std::tuple(each.waits, each.waits ? -static_cast<std::ptrdiff_t>(each.answered) : 0,
                      each.deadline);
  };
  std::size_t count = 0;
  auto first = connections_.end();
  for (auto each = connections_.begin(); each != connections_.end(); ++each) {
    if ((*each)->silent != silent) continue;
    ++count;
    if (first == connections_.end() || rank(**each) < rank(**first)) first = each;
  }
  if (count < (silent ? kMostSilent : kMostConnections)) return true;
  if ((*first)->waits && (*first)->answered == 0) return false;
  (*first)->close();
  connections_.erase(first);
  return true;
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
  co_await answerAll(connection);
  connection->close();
  std::erase(connections_, connection);
}

asio::awaitable<void> HttpServer::answerAll(const std::shared_ptr<Connection>& connection) {
  for (std::size_t number = 1; number <= kMostRequests; ++number) {
    connection->deadline = clock_.now() + kTimeout;
    boost::system::error_code ec;
    const auto request = co_await awaitRequest(connection, ec);
    if (!request) co_return;
    HttpResponse response = respond(*request, ec, number < kMostRequests, host_names_,
                                    [this] { return collectFreshMetrics(); });
    connection->deadline = clock_.now() + kTimeout;
    ++connection->answered;
    co_await boost::beast::http::async_write(connection->socket, response,
                                             asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
    if (!response.keep_alive()) co_return co_await finish(*connection);
  }
}

asio::awaitable<std::optional<HttpRequest>> HttpServer::awaitRequest(
    const std::shared_ptr<Connection>& connection, boost::system::error_code& error) {
  boost::beast::flat_buffer& buffer = connection->buffer;
  for (;;) {
    if (buffer.size() > 0) {
      if (!co_await awaitTurn(connection)) co_return std::nullopt;
      if (auto request = readRequest(buffer, error)) co_return request;
    }
    const std::size_t room = buffer.max_size() - buffer.size();
    boost::system::error_code ec;
    const std::size_t size = co_await connection->socket.async_read_some(
        buffer.prepare(room), asio::redirect_error(asio::use_awaitable, ec));
    if (ec || (connection->silent && !makeRoom(false))) co_return std::nullopt;
    connection->silent = false;
    buffer.commit(size);
  }
}

asio::awaitable<bool> HttpServer::awaitTurn(std::shared_ptr<Connection> connection) {
  // Turns by connection: one with fewer answers comes first.
  const auto place = std::find_if(waiting_.begin(), waiting_.end(), [&](const auto& each) {
    return each->answered > connection->answered;
  });
  waiting_.insert(place, connection);
  connection->waits = true;
  for (;;) {
    const auto now = asio::steady_timer::clock_type::now();
    const bool first = waiting_.front() == connection;
    if ((first && now >= next_turn_) || !connection->socket.is_open()) break;
    connection->turn.expires_at(first ? next_turn_ : asio::steady_timer::time_point::max());
    boost::system::error_code ec;
    co_await connection->turn.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
  std::erase(waiting_, connection);
  connection->waits = false;
  if (!waiting_.empty()) waiting_.front()->turn.cancel();  // it may be the first now
  if (!connection->socket.is_open()) co_return false;
  next_turn_ = asio::steady_timer::clock_type::now() + kTurnEvery;
  co_return true;
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
