// SPDX-License-Identifier: MIT
#include "client/net/dial.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "common/transport/tcp_channel.hpp"

namespace hapticast::client {

namespace {

using Addresses = asio::ip::tcp::resolver::results_type;
const DialError kStopped{"stopped"};

/// Returns the addresses of localhost, which are the same everywhere (RFC 6761). A small system may
/// have no resolver, and a list of hosts may lack one family. The last address gives the error.
Addresses makeLocalhost(std::uint16_t port) {
  const std::array<asio::ip::tcp::endpoint, 2> both{
      {{asio::ip::address_v6::loopback(), port}, {asio::ip::address_v4::loopback(), port}}};
  return Addresses::create(both.begin(), both.end(), "localhost", "");
}

asio::awaitable<Result<Addresses, DialError>> lookUp(asio::io_context& io, const Endpoint& server,
                                                     Duration deadline, DialCancellation& stop) {
  if (server.host == "localhost") co_return makeLocalhost(server.port);
  // A look-up cannot be interrupted. It races against a timer, and a late one ends by itself.
  struct Race {
    explicit Race(asio::io_context& context) : resolver(context), timer(context) {}
    asio::ip::tcp::resolver resolver;
    asio::steady_timer timer;
    std::optional<boost::system::error_code> ec;
    Addresses addresses;
  };
  auto race = std::make_shared<Race>(io);
  race->timer.expires_after(deadline);
  race->resolver.async_resolve(server.host, std::to_string(server.port),
                               [race](boost::system::error_code ec, Addresses addresses) {
                                 race->ec = ec;
                                 race->addresses = std::move(addresses);
                                 race->timer.cancel();
                               });
  stop.onStop([race] { race->timer.cancel(); });
  boost::system::error_code ignored;
  co_await race->timer.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  stop.onStop({});
  if (stop.stopped()) co_return kStopped;
  if (!race->ec) co_return DialError{"the name resolution timed out"};
  if (*race->ec == asio::error::host_not_found)
    co_return DialError{"there is no host of this name", true};
  if (*race->ec) co_return DialError{"the name cannot be resolved: " + race->ec->message()};
  co_return race->addresses;
}

using Connected = Result<asio::ip::tcp::socket, DialError>;

asio::awaitable<Connected> connectTcp(asio::io_context& io, const Endpoint& server,
                                      Duration deadline, DialCancellation& stop) {
  const auto addresses = co_await lookUp(io, server, deadline, stop);
  if (!addresses.ok()) co_return addresses.error();

  // Shared, because the timer's handler may be queued when the connection succeeds.
  struct Race {
    explicit Race(asio::io_context& context) : socket(context), timer(context) {}
    void giveUp() {
      boost::system::error_code ignored;
      socket.close(ignored);
    }
    asio::ip::tcp::socket socket;
    asio::steady_timer timer;
    bool over = false;
    bool timed_out = false;
  };
  auto race = std::make_shared<Race>(io);
  race->timer.expires_after(deadline);
  race->timer.async_wait([race](const boost::system::error_code&) {
    if (race->over) return;
    race->timed_out = true;
    race->giveUp();
  });
  stop.onStop([race] { race->giveUp(); });
  boost::system::error_code ec;
  co_await asio::async_connect(race->socket, addresses.value(),
                               asio::redirect_error(asio::use_awaitable, ec));
  stop.onStop({});
  race->over = true;
  race->timer.cancel();
  if (stop.stopped()) co_return kStopped;
  if (race->timed_out) co_return DialError{"no answer"};
  if (ec == asio::error::connection_refused) co_return DialError{"connection refused"};
  if (ec) co_return DialError{ec.message()};
  co_return std::move(race->socket);
}

/// Completes the handshake of `channel`. Returns the error in one line, or nullopt.
asio::awaitable<std::optional<Error>> completeHandshake(asio::io_context& io, TcpChannel& channel,
                                                        Duration deadline, DialCancellation& stop) {
  // Shared, because the timer's handler may be queued when the handshake succeeds.
  struct Race {
    explicit Race(asio::io_context& context) : timer(context) {}
    asio::steady_timer timer;
    bool over = false;
    bool timed_out = false;
  };
  auto race = std::make_shared<Race>(io);
  race->timer.expires_after(deadline);
  race->timer.async_wait([race, &channel](const boost::system::error_code&) {
    if (race->over) return;
    race->timed_out = true;
    channel.close();
  });
  stop.onStop([&channel] { channel.close(); });
  auto failure = co_await channel.completeHandshake();
  stop.onStop({});
  race->over = true;
  race->timer.cancel();
  if (stop.stopped()) co_return Error{kStopped.message};
  if (race->timed_out) co_return Error{"the server does not answer with TLS"};
  co_return failure;
}

asio::awaitable<Dialled> dialTls(TlsContext context, FingerprintCheck check, asio::io_context& io,
                                 Endpoint server, Duration deadline, DialCancellation& stop) {
  Connected socket = co_await connectTcp(io, server, deadline, stop);
  if (!socket.ok()) co_return socket.error();
  auto tls = std::make_unique<TlsEngine>(context, server.host, std::move(check));
  auto channel = std::make_unique<TcpChannel>(std::move(socket).value(), kMaxSmallMessageBytes,
                                              std::move(tls));
  const auto failure = co_await completeHandshake(io, *channel, deadline, stop);
  if (failure) co_return DialError{failure->message, false, channel->untrusted()};
  co_return channel;
}

}  // namespace

asio::awaitable<Dialled> dialTcp(asio::io_context& io, const Endpoint& server, Duration deadline,
                                 DialCancellation& stop) {
  Connected socket = co_await connectTcp(io, server, deadline, stop);
  if (!socket.ok()) co_return socket.error();
  co_return std::make_unique<TcpChannel>(std::move(socket).value(), kMaxSmallMessageBytes);
}

Dial makeTlsDial(TlsContext context, FingerprintCheck check) {
  return
      [context = std::move(context), check = std::move(check)](
          asio::io_context& io, const Endpoint& server, Duration deadline, DialCancellation& stop) {
        return dialTls(context, check, io, server, deadline, stop);
      };
}

}  // namespace hapticast::client
