// SPDX-License-Identifier: MIT
#include "client/commands/control_command.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "client/servers/server_trust.hpp"

namespace hapticast::client {

namespace {

// A seek in a long clip lasts as long as vision needs for the frames before; chosen. Meanwhile the
// server may be silent.
constexpr auto kCarryOutPatience = std::chrono::minutes(2);

/// State of one request.
struct Exchange {
  explicit Exchange(asio::io_context& context) : io(context), timer(context) {}
  asio::io_context& io;
  const SteadyClock clock;
  asio::steady_timer timer;
  DialCancellation never;  // a dial has its own time limit
  std::unique_ptr<Channel> channel;
  LocalTime latest = LocalTime::max();  // for the answer
  bool ended = false;
  bool done = false;
  std::string problem;

  void end(std::string why) {
    if (ended) return;
    ended = true;
    problem = std::move(why);
    timer.cancel();
    if (channel) channel->close();
  }
};

/// Ends the request when a time limit has passed.
void watch(Exchange& exchange, const ClientSession& session) {
  if (exchange.ended) return;
  const LocalTime now = exchange.clock.now();
  if (const auto expired = session.expire(now)) return exchange.end(expired->why);
  if (now >= exchange.latest)
    return exchange.end("the server has not carried out the request in 2 minutes");
  exchange.timer.expires_after(std::min(session.nextDeadline(), exchange.latest) - now);
  exchange.timer.async_wait(
      [&](const boost::system::error_code& /*cancelled*/) { watch(exchange, session); });
}

/// Handles a message of the server.
void handle(Exchange& exchange, ClientSession& session, const Message& message,
            const Control& control) {
  if (std::holds_alternative<Control>(message)) {
    exchange.done = true;
    exchange.end("");
  } else if (std::holds_alternative<Welcome>(message) && session.welcomes() == 1) {
    if (session.description().timeline)
      return exchange.end("each viewer of this server has a time line of its own (--on-demand)");
    (void)session.request(control);
    exchange.latest = exchange.clock.now() + kCarryOutPatience;
  }
}

/// Runs a session until the server has answered the request. All parameters outlive the coroutine.
asio::awaitable<void> request(Exchange& exchange, const Dial& dial, const Endpoint& server,
                              ClientSession& session, const Control& control) {
  const SteadyClock& clock = exchange.clock;
  Dialled dialled =
      co_await dial(exchange.io, server, SessionSettings().connect_deadline, exchange.never);
  if (!dialled.ok()) co_return exchange.end(dialled.error().message);
  exchange.channel = std::move(dialled).value();
  Channel& channel = *exchange.channel;
  if (const auto refusal =
          session.open({channel.encrypted(), channel.ofThisMachine()}, clock.now()))
    co_return exchange.end(refusal->why);
  watch(exchange, session);
  while (!exchange.done) {
    while (const auto message = session.poll(clock.now()))
      (void)co_await channel.write(encodeShared(*message));  // read() knows whether it has ended
    const auto payload = co_await channel.read();
    if (!payload.ok()) co_return exchange.end(payload.error().message);
    if (!payload.value()) break;
    const auto message = session.receive(*payload.value(), clock.now());
    if (!message.ok()) co_return exchange.end(message.error().why);
    channel.setReadLimit(session.readLimit());
    handle(exchange, session, message.value(), control);
  }
  exchange.end("the server has ended the connection");
}

}  // namespace

bool controlServer(const Settings& settings) {
  const std::string server = nameServer(settings);
  asio::io_context io;
  Exchange exchange(io);
  SessionSettings of_session = makeSessionSettings(settings, server);
  of_session.client_name = "hapticast-client control";
  of_session.silence_limit = kCarryOutPatience;
  of_session.sends_pings = false;
  ClientSession session(std::move(of_session), nullptr);
  const Dial dial = chooseDial(settings, server);
  asio::co_spawn(io, request(exchange, dial, settings.server, session, *settings.control),
                 asio::detached);
  io.run();
  if (!exchange.done) spdlog::error("{}: {}", server, exchange.problem);
  return exchange.done;
}

}  // namespace hapticast::client
