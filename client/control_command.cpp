// SPDX-License-Identifier: MIT
#include "client/control_command.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <utility>

#include "client/server_trust.hpp"

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

/// Handles a message of the server. Returns the next message to send, if there is one.
std::optional<Control> answer(Exchange& exchange, const Message& message, const Control& control) {
  if (const auto* const welcome = std::get_if<Welcome>(&message)) {
    if (welcome->description.timeline) {
      exchange.end("each viewer of this server has a time line of its own (--on-demand)");
      return std::nullopt;
    }
    exchange.limit(kCarryOutPatience, "the server has not carried out the request in 2 minutes");
    return control;
  }
  if (std::holds_alternative<Control>(message)) {
    exchange.done = true;
    exchange.end("");
  } else if (const auto* const error = std::get_if<WireError>(&message)) {
    exchange.end(error->message);
  }
  return std::nullopt;
}

asio::awaitable<void> request(Exchange& exchange, Dial dial, Endpoint server, Hello hello,
                              Control control, bool insecure) {
  Dialled dialled = co_await dial(exchange.io, server, kControlPatience, exchange.stop);
  if (!dialled.ok()) {
    exchange.end(dialled.error().message);
    co_return;
  }
  if (!hello.access_token.empty() && !mayHaveToken(*dialled.value(), insecure)) {
    exchange.end(kTokenUnprotected);
    co_return;
  }
  exchange.channel = std::move(dialled).value();
  exchange.channel->setReadLimit(kMaxMessageBytes);
  bool sending = co_await exchange.channel->write(encodeShared(hello));
  while (sending && !exchange.done) {
    const auto payload = co_await exchange.channel->read();
    if (!payload.ok() || !payload.value()) break;
    const auto message = decode(*payload.value());
    if (!message.ok()) break;
    if (const auto next = answer(exchange, message.value(), control))
      sending = co_await exchange.channel->write(encodeShared(*next));
  }
  exchange.timer.cancel();
}

}  // namespace

bool controlServer(const Settings& settings) {
  const std::string server = nameServer(settings);
  asio::io_context io;
  Exchange exchange(io);
  const Hello hello{kProtocolVersion, "hapticast-client --control", false, false,
                    loadToken(settings.token_file)};
  asio::co_spawn(io,
                 request(exchange, chooseDial(settings, server), settings.server, hello,
                         *settings.control, settings.insecure),
                 asio::detached);
  exchange.limit(kControlPatience, "the server did not answer in time");
  io.run();
  if (!exchange.done) spdlog::error("{}: {}", server, exchange.problem);
  return exchange.done;
}

}  // namespace hapticast::client
