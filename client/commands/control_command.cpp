// SPDX-License-Identifier: MIT
#include "client/commands/control_command.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <utility>

#include "client/trust/server_trust.hpp"

namespace hapticast::client {

namespace {

constexpr auto kControlPatience = std::chrono::seconds(5);
// A seek in a long clip lasts as long as vision needs for the frames before; chosen.
constexpr auto kCarryOutPatience = std::chrono::minutes(2);

/// State of one request, which its coroutines share.
struct Exchange {
  explicit Exchange(asio::io_context& context) : io(context), timer(context) {}
  asio::io_context& io;
  asio::steady_timer timer;
  DialCancellation stop;
  std::unique_ptr<Channel> channel;
  bool done = false;
  std::string problem = "the server has ended the connection";

  /// Ends the request with `why` after `patience`. Replaces the limit before.
  void limit(Duration patience, std::string why) {
    timer.expires_after(patience);
    timer.async_wait([this, why = std::move(why)](const boost::system::error_code& cancelled) {
      if (cancelled) return;
      problem = why;
      stop.stop();
      if (channel) channel->close();
    });
  }
  void end(std::string why) {
    problem = std::move(why);
    timer.cancel();
    if (channel) channel->close();
  }
};

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
    exchange.limit(kCarryOutPatience, "the server has not carried out the request in 2 minutes");
  }
}

/// Runs a session until the server has answered the request.
asio::awaitable<void> request(Exchange& exchange, Dial dial, Endpoint server,
                              ClientSession& session, Control control) {
  const SteadyClock clock;
  Dialled dialled = co_await dial(exchange.io, server, kControlPatience, exchange.stop);
  if (!dialled.ok()) co_return exchange.end(dialled.error().message);
  exchange.channel = std::move(dialled).value();
  Channel& channel = *exchange.channel;
  if (const auto refusal =
          session.open({channel.encrypted(), channel.ofThisMachine()}, clock.now()))
    co_return exchange.end(refusal->why);
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
  exchange.timer.cancel();
}

}  // namespace

bool controlServer(const Settings& settings) {
  const std::string server = nameServer(settings);
  asio::io_context io;
  Exchange exchange(io);
  SessionSettings of_session = makeSessionSettings(settings, server);
  of_session.client_name = "hapticast-client --control";
  of_session.sends_pings = false;
  ClientSession session(std::move(of_session), nullptr);
  asio::co_spawn(
      io,
      request(exchange, chooseDial(settings, server), settings.server, session, *settings.control),
      asio::detached);
  exchange.limit(kControlPatience, "the server did not answer in time");
  io.run();
  if (!exchange.done) spdlog::error("{}: {}", server, exchange.problem);
  return exchange.done;
}

}  // namespace hapticast::client
