// SPDX-License-Identifier: MIT
#include "client/net/connection.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

namespace {

constexpr std::size_t kChunkBytes = 64U << 10U;
constexpr auto kCheckEvery = std::chrono::milliseconds(50);
constexpr std::size_t kMaxPingsOut = 64;

}  // namespace

struct Connection::Link {
  explicit Link(asio::io_context& io) : socket(io), pinger(io), watcher(io) {}

  void close() {
    boost::system::error_code ignored;
    socket.close(ignored);
    pinger.cancel();
    watcher.cancel();
  }

  asio::ip::tcp::socket socket;
  asio::steady_timer pinger;
  asio::steady_timer watcher;
  FrameReader reader{kMaxSmallMessageBytes};
  bool welcomed = false;
  bool pinging = false;
  bool timed_out = false;  // closed because `deadline` passed
  LocalTime deadline{};
  const char* overdue = "";     // what did not come in time
  std::deque<LocalTime> pings;  // sent and not answered
};

Connection::Connection(asio::io_context& io, const Clock& clock, ConnectionSettings settings,
                       Receiver& receiver, ConnectionEvents events)
    : io_(io),
      clock_(clock),
      settings_(std::move(settings)),
      receiver_(receiver),
      events_(std::move(events)),
      retry_(io) {}

void Connection::start() {
  asio::co_spawn(
      io_, [this] { return run(); }, asio::detached);
}

void Connection::stop() {
  asio::post(io_, [this] {
    stopped_ = true;
    retry_.cancel();
    if (link_) link_->close();
  });
}

std::string Connection::target() const {
  return settings_.host + ":" + std::to_string(settings_.port);
}

asio::awaitable<void> Connection::run() {
  Duration pause = settings_.first_retry;
  while (!stopped_) {
    const Error why = co_await attempt();
    const bool was_welcomed = link_ && link_->welcomed;
    link_.reset();
    if (stopped_) break;
    if (was_welcomed) {
      receiver_.disconnected(clock_.now());
      pause = settings_.first_retry;
    }
    const std::string line = target() + ": " + why.message;
    const bool hopeless =
        !ever_welcomed_ && !settings_.patient && why.code != ErrorCode::kServerFull;
    if (hopeless || why.code == ErrorCode::kVersion) {
      if (events_.failed) events_.failed(line);
      co_return;
    }
    if (events_.disconnected) events_.disconnected(line);
    retry_.expires_after(pause);
    boost::system::error_code ec;
    co_await retry_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    pause = std::min(2 * pause, settings_.last_retry);
  }
  receiver_.disconnected(clock_.now());
}

asio::awaitable<Result<Connection::Endpoints>> Connection::resolve() {
  // A look-up cannot be interrupted, so it is raced against a timer and left behind when it loses.
  struct Race {
    explicit Race(asio::io_context& io) : resolver(io), timer(io) {}
    asio::ip::tcp::resolver resolver;
    asio::steady_timer timer;
    std::optional<boost::system::error_code> ec;
    Endpoints endpoints;
  };
  auto race = std::make_shared<Race>(io_);
  race->timer.expires_after(settings_.connect_deadline);
  race->resolver.async_resolve(settings_.host, std::to_string(settings_.port),
                               [race](boost::system::error_code ec, Endpoints endpoints) {
                                 race->ec = ec;
                                 race->endpoints = std::move(endpoints);
                                 race->timer.cancel();
                               });
  boost::system::error_code ec;
  co_await race->timer.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  if (!race->ec) co_return Error{ErrorCode::kTimeout, "the name look-up takes too long"};
  if (*race->ec) {
    co_return Error{ErrorCode::kTimeout,
                    "unknown host; is the name right? (" + race->ec->message() + ")"};
  }
  co_return race->endpoints;
}

asio::awaitable<Error> Connection::attempt() {
  const auto endpoints = co_await resolve();
  if (!endpoints.ok()) co_return endpoints.error();
  if (stopped_) co_return Error{ErrorCode::kShuttingDown, "stopped"};

  auto link = link_ = std::make_shared<Link>(io_);
  link->deadline = clock_.now() + settings_.connect_deadline;
  asio::co_spawn(
      io_, [this, link] { return watch(link); }, asio::detached);
  boost::system::error_code ec;
  co_await asio::async_connect(link->socket, endpoints.value(),
                               asio::redirect_error(asio::use_awaitable, ec));
  if (ec) {
    link->close();
    if (link->timed_out) co_return Error{ErrorCode::kTimeout, "cannot connect: no answer"};
    const char* const advice =
        ec == asio::error::connection_refused ? " (no hapticast-server listens there)" : "";
    co_return Error{ErrorCode::kTimeout, "cannot connect: " + ec.message() + advice};
  }
  link->socket.set_option(asio::ip::tcp::no_delay(true), ec);
  link->deadline = clock_.now() + settings_.connect_deadline;
  link->overdue = "no welcome came; is it a hapticast server?";
  const Hello hello{kProtocolVersion, settings_.client_name, settings_.wants_video, true};
  std::optional<Error> failure;
  if (co_await send(link, hello)) failure = co_await readAll(link);
  link->close();
  co_return failure.value_or(Error{ErrorCode::kTimeout, "the connection was lost"});
}

asio::awaitable<void> Connection::watch(LinkPtr link) {
  while (clock_.now() < link->deadline) {
    boost::system::error_code ec;
    link->watcher.expires_after(kCheckEvery);
    co_await link->watcher.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
  }
  link->timed_out = true;
  link->close();
}

asio::awaitable<bool> Connection::send(LinkPtr link, Message message) {
  const SharedBytes bytes = framed(encode(message));
  boost::system::error_code ec;
  co_await asio::async_write(link->socket, asio::buffer(*bytes),
                             asio::redirect_error(asio::use_awaitable, ec));
  co_return !ec;
}

asio::awaitable<void> Connection::ping(LinkPtr link) {
  for (std::size_t sent = 1;; ++sent) {
    const LocalTime now = clock_.now();
    link->pings.push_back(now);
    if (link->pings.size() > kMaxPingsOut) link->pings.pop_front();
    if (!co_await send(link, Ping{now})) co_return;
    const bool burst = sent < ClockSync::kBurst;
    if (!burst && !co_await send(link, report())) co_return;
    boost::system::error_code ec;
    link->pinger.expires_after(burst ? settings_.burst_interval : settings_.ping_interval);
    co_await link->pinger.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
  }
}

asio::awaitable<std::optional<Error>> Connection::readAll(LinkPtr link) {
  std::vector<std::uint8_t> chunk(kChunkBytes);
  for (;;) {
    boost::system::error_code ec;
    const std::size_t size = co_await link->socket.async_read_some(
        asio::buffer(chunk), asio::redirect_error(asio::use_awaitable, ec));
    if (link->timed_out) co_return Error{ErrorCode::kTimeout, link->overdue};
    if (ec) co_return Error{ErrorCode::kTimeout, "the connection was lost (" + ec.message() + ")"};
    bytes_received_ += size;
    if (auto error = handleChunk(*link, std::span(chunk).first(size))) co_return error;
    if (link->welcomed && !link->pinging) {
      link->pinging = true;
      asio::co_spawn(
          io_, [this, link] { return ping(link); }, asio::detached);
    }
  }
}

std::optional<Error> Connection::handleChunk(Link& link, std::span<const std::uint8_t> chunk) {
  link.reader.feed(chunk);
  for (;;) {
    const auto bytes = link.reader.next();
    if (!bytes.ok()) return bytes.error();
    if (!bytes.value()) return std::nullopt;
    auto message = decode(*bytes.value());
    if (!message.ok()) return message.error();
    if (auto error = handle(link, std::move(message).value())) return error;
  }
}

std::optional<Error> Connection::handleWelcome(Link& link, const Message& message) {
  const auto* const welcome = std::get_if<Welcome>(&message);
  if (welcome == nullptr) return Error{ErrorCode::kUnexpected, "the first message is no welcome"};
  if (welcome->protocol_version != kProtocolVersion) {
    return Error{ErrorCode::kVersion, "the server speaks protocol version " +
                                          std::to_string(welcome->protocol_version) +
                                          ", this client " + std::to_string(kProtocolVersion)};
  }
  link.welcomed = true;
  ever_welcomed_ = true;
  link.reader.setLimit(kMaxMessageBytes);
  receiver_.connected(welcome->description, clock_.now());
  if (events_.welcomed) events_.welcomed(welcome->description);
  return std::nullopt;
}

std::optional<Error> Connection::handle(Link& link, Message message) {
  if (auto* const error = std::get_if<Error>(&message)) return std::move(*error);
  const LocalTime now = clock_.now();
  std::optional<Error> failure;
  if (!link.welcomed) {
    failure = handleWelcome(link, message);
  } else if (auto* const frame = std::get_if<HapticFrame>(&message)) {
    receiver_.frame(std::move(*frame));
  } else if (const auto* const pong = std::get_if<Pong>(&message)) {
    handlePong(link, *pong);
  } else if (auto* const video = std::get_if<VideoFrame>(&message)) {
    if (events_.video) events_.video(std::move(*video));
  } else if (const auto* const description = std::get_if<StreamDescription>(&message)) {
    receiver_.describe(*description, now);
  } else {
    failure = Error{ErrorCode::kUnexpected, "the server sent what only clients send"};
  }
  link.deadline = now + settings_.silence_limit;
  link.overdue = "the server has gone silent";
  return failure;
}

void Connection::handlePong(Link& link, const Pong& pong) {
  // Only what was asked counts, and once.
  const auto asked = std::find(link.pings.begin(), link.pings.end(), pong.t0);
  if (asked == link.pings.end()) return;
  link.pings.erase(asked);
  receiver_.pong(pong, clock_.now());
}

Report Connection::report() const {
  const ReceiverCounts& counts = receiver_.counts();
  const auto milliseconds = [](Duration time) { return 1e3 * toSeconds(time); };
  return {counts.received,
          counts.lost,
          counts.late,
          milliseconds(receiver_.stream().playout_delay_target),
          1e3 * milliseconds(receiver_.clockErrorBound()),
          in_contact_};
}

}  // namespace hapticast::client
