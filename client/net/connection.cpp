// SPDX-License-Identifier: MIT
#include "client/net/connection.hpp"

#include <algorithm>
#include <utility>

#include "client/net/welcome_limiter.hpp"
#include "common/protocol/signed_frame.hpp"

namespace hapticast::client {

namespace {

constexpr auto kCheckEvery = std::chrono::milliseconds(50);
constexpr std::size_t kMostControls = 16;  // chosen: more than a user presses in a moment
constexpr std::size_t kMaxPingsOut = 64;   // older unanswered pings are dropped

/// Returns the key of `welcome`; nullopt if the server signs nothing.
Result<std::optional<VerifyingKey>, WireError> readKey(const Welcome& welcome) {
  if (!welcome.verifying_key) return std::optional<VerifyingKey>();
  auto key = VerifyingKey::from(*welcome.verifying_key);
  if (!key.ok()) return WireError{ErrorCode::kMalformed, "the server's key is not valid"};
  return std::optional<VerifyingKey>(std::move(key).value());
}

}  // namespace

struct Connection::Session {
  Session(asio::io_context& io, std::unique_ptr<Channel> over)
      : channel(std::move(over)), pinger(io), watcher(io) {}

  void close() {
    closed = true;
    if (link) link->close();
    channel->close();
    pinger.cancel();
    watcher.cancel();
  }

  /// Returns the next request to the server; nullopt: none waits.
  std::optional<Message> takeRequest() {
    if (order) return std::exchange(order, std::nullopt);
    if (controls.empty()) return std::nullopt;
    const Control next = controls.front();
    controls.pop_front();
    return next;
  }

  std::unique_ptr<Channel> channel;
  std::shared_ptr<UdpReceiver> link;  // null: frames arrive over TCP only
  std::optional<Delivery> order;      // next request to the server
  std::deque<Control> controls;       // requests that wait to be sent
  asio::steady_timer pinger;
  asio::steady_timer watcher;
  std::optional<VerifyingKey> key;  // absent: the server signs nothing
  std::uint32_t stream = 0;
  StreamDescription description;
  bool closed = false;
  bool welcomed = false;
  bool wrong_origin = false;
  RateLimiter welcomes = makeWelcomeLimiter();
  std::optional<LocalTime> unanswered_since;  // welcome without an answered ping yet
  bool pinging = false;
  std::size_t sent_pings = 0;  // since the newest welcome
  LocalTime next_ping{};
  std::optional<LocalTime> first_frame;
  bool timed_out = false;  // closed because `deadline` passed
  LocalTime deadline{};
  const char* overdue = "";     // message of the timeout
  std::deque<LocalTime> pings;  // sent and unanswered
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
    dial_stop_.stop();
    if (session_) session_->close();
  });
}

std::uint64_t Connection::bytesReceived() const {
  if (!session_) return bytes_received_;
  return bytes_received_ + session_->channel->bytesRead() +
         (session_->link ? session_->link->bytesReceived() : 0);
}

DatagramCounts Connection::datagrams() const {
  return session_ && session_->link ? datagrams_ + session_->link->counts() : datagrams_;
}

DeliveryStats Connection::delivery() const {
  return session_ && session_->link ? session_->link->state() : delivery_;
}

asio::awaitable<void> Connection::run() {
  Duration pause = settings_.first_retry;
  while (!stopped_) {
    const CloseReason ending = co_await runSession();
    const bool was_welcomed = session_ && session_->welcomed;
    const bool was_good = session_ && session_->first_frame &&
                          clock_.now() - *session_->first_frame >= settings_.good_after;
    bytes_received_ = bytesReceived();
    datagrams_ = datagrams();
    delivery_ = delivery();
    session_.reset();
    if (stopped_) break;
    if (was_welcomed) receiver_.disconnected(clock_.now());
    if (was_good) pause = settings_.first_retry;
    if (isPermanent(ending)) {
      if (events_.failed) events_.failed(ending.why);
      co_return;
    }
    if (ending.code == ErrorCode::kShuttingDown && events_.goodbye) events_.goodbye();
    if (events_.disconnected) events_.disconnected(ending.why);
    retry_.expires_after(pause);
    boost::system::error_code ec;
    co_await retry_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    pause = std::min(2 * pause, settings_.last_retry);
  }
  receiver_.disconnected(clock_.now());
}

bool Connection::isPermanent(const CloseReason& ending) const {
  if (ending.untrusted || ending.code == ErrorCode::kVersion ||
      ending.code == ErrorCode::kUnauthorized || ending.code == ErrorCode::kForbidden)
    return true;
  const bool speaks_something_else = ending.code == ErrorCode::kMalformed ||
                                     ending.code == ErrorCode::kTooLarge ||
                                     ending.code == ErrorCode::kUnexpected;
  return !ever_welcomed_ && (ending.no_such_server || speaks_something_else);
}

asio::awaitable<Connection::CloseReason> Connection::runSession() {
  Dialled dialled =
      co_await settings_.dial(io_, settings_.server, settings_.connect_deadline, dial_stop_);
  if (!dialled.ok())
    co_return CloseReason{
        dialled.error().message, {}, dialled.error().no_such_server, dialled.error().untrusted};
  if (!settings_.access_token.empty() && !mayHaveToken(*dialled.value(), settings_.insecure)) {
    co_return CloseReason{.why = kTokenUnprotected, .code = {}, .untrusted = true};
  }
  auto session = session_ = std::make_shared<Session>(io_, std::move(dialled).value());
  session->deadline = clock_.now() + settings_.connect_deadline;
  session->overdue = "no welcome arrived; is it a hapticast server?";
  asio::co_spawn(
      io_, [this, session] { return startTimer(session); }, asio::detached);
  const Hello hello{kProtocolVersion, settings_.client_name, settings_.wants_video, true,
                    settings_.access_token};
  CloseReason ending{"the connection was lost", {}};
  if (co_await send(session, hello)) ending = co_await readAll(session);
  session->close();
  co_return ending;
}

asio::awaitable<void> Connection::startTimer(ConversationPtr session) {
  while (clock_.now() < session->deadline) {
    if (session->unanswered_since &&
        clock_.now() - *session->unanswered_since >= settings_.pong_limit) {
      session->overdue = "the server answers no pings, so the client cannot synchronize the clocks";
      break;
    }
    boost::system::error_code ec;
    session->watcher.expires_after(kCheckEvery);
    co_await session->watcher.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    if (ec) co_return;
  }
  session->timed_out = true;
  session->close();
}

asio::awaitable<bool> Connection::send(ConversationPtr session, Message message) {
  co_return co_await session->channel->write(encodeShared(message));
}

asio::awaitable<void> Connection::writeLoop(ConversationPtr session) {
  while (!session->closed) {
    if (const auto request = session->takeRequest()) {
      if (!co_await send(session, *request)) co_return;
    } else if (clock_.now() >= session->next_ping) {
      const bool burst = ++session->sent_pings < ClockSync::kBurst;
      session->next_ping =
          clock_.now() + (burst ? settings_.burst_interval : settings_.ping_interval);
      if (!co_await ping(session, !burst)) co_return;
    } else {
      boost::system::error_code woken;
      session->pinger.expires_after(session->next_ping - clock_.now());
      co_await session->pinger.async_wait(asio::redirect_error(asio::use_awaitable, woken));
    }
  }
}

void Connection::control(const Control& control) {
  if (!session_ || !session_->welcomed || !session_->description.timeline ||
      session_->controls.size() >= kMostControls)
    return;
  session_->controls.push_back(control);
  session_->pinger.cancel();
}

asio::awaitable<bool> Connection::ping(ConversationPtr session, bool with_report) {
  const LocalTime now = clock_.now();
  session->pings.push_back(now);
  if (session->pings.size() > kMaxPingsOut) session->pings.pop_front();
  if (!co_await send(session, Ping{now})) co_return false;
  // Not `!with_report || co_await ...`: built by GCC 12, that sent a report in any case.
  if (!with_report) co_return true;
  co_return co_await send(session, report());
}

asio::awaitable<Connection::CloseReason> Connection::readAll(ConversationPtr session) {
  for (;;) {
    const auto payload = co_await session->channel->read();
    if (session->timed_out) co_return CloseReason{session->overdue, ErrorCode::kTimeout};
    if (!payload.ok()) co_return CloseReason{payload.error().message, payload.error().code};
    if (!payload.value()) {
      co_return CloseReason{"the connection was lost (" + session->channel->whyEnded() + ")", {}};
    }
    auto message = decode(*payload.value());
    auto error = message.ok() ? checkSignature(*session, message.value(), *payload.value())
                              : message.error();
    if (!error) error = handle(*session, std::move(message).value());
    if (error)
      co_return CloseReason{.why = std::move(error->message),
                            .code = error->code,
                            .untrusted = session->wrong_origin};
    if (session->welcomed && !session->pinging) {
      session->pinging = true;
      asio::co_spawn(
          io_, [this, session] { return writeLoop(session); }, asio::detached);
    }
  }
}

std::optional<WireError> Connection::checkSignature(const Session& session, const Message& message,
                                                    std::span<const std::uint8_t> bytes) {
  if (!session.key || !std::holds_alternative<CodedFrame>(message) ||
      verifyFrame(bytes, session.stream, *session.key))
    return std::nullopt;
  return WireError{ErrorCode::kMalformed,
                   "a frame has no valid signature: somebody on the way may have changed it"};
}

std::optional<WireError> Connection::handleWelcome(Session& session, const Welcome& welcome) {
  if (welcome.protocol_version != kProtocolVersion) {
    return WireError{ErrorCode::kVersion, "the server has protocol version " +
                                              std::to_string(welcome.protocol_version) +
                                              ", this client " + std::to_string(kProtocolVersion)};
  }
  if (welcome.datagram_key && !session.channel->encrypted())
    return WireError{ErrorCode::kUnexpected, "a key of datagrams arrived without TLS"};
  auto key = readKey(welcome);
  if (!key.ok()) return key.error();
  if (auto refusal = settings_.origin.refuse(welcome.verifying_key)) {
    session.wrong_origin = true;
    return WireError{ErrorCode::kUnexpected, std::move(*refusal)};
  }
  const LocalTime now = clock_.now();
  if (session.welcomed) {
    if (!session.welcomes.allow(now))
      return WireError{ErrorCode::kUnexpected, "the server changes its origin too often"};
    leaveOrigin(session);
  }
  const bool is_new = !session.welcomed || !(session.description == welcome.description);
  session.key = std::move(key).value();
  session.stream = welcome.stream;
  keys_.begin(welcome.datagram_key);
  session.description = welcome.description;
  session.welcomed = true;
  session.unanswered_since = session.next_ping = now;
  session.sent_pings = 0;
  session.pinger.cancel();
  ever_welcomed_ = true;
  session.channel->setReadLimit(kMaxMessageBytes);
  receiver_.connected(welcome.description, now);
  if (is_new && events_.welcomed) events_.welcomed(welcome.description);
  openLink(session, welcome);
  return std::nullopt;
}

void Connection::leaveOrigin(Session& session) {
  session.pings.clear();  // their pongs would mix two media clocks
  if (session.link) {
    bytes_received_ += session.link->bytesReceived();
    datagrams_ = datagrams();
    delivery_ = {};
    session.link->close();
    session.link.reset();
    session.order = Delivery{};  // replaces an order that is under way to the server
  }
  receiver_.disconnected(clock_.now());
  if (events_.delivery) events_.delivery("another server makes the stream from now on");
}

void Connection::openLink(Session& session, const Welcome& welcome) {
  const auto server = parseEndpoint(session.channel->peer(), {});
  if (!server) return;  // a channel that is no connection between hosts
  // The session closes its link before its own end.
  session.link = UdpReceiver::open(io_, clock_, receiver_, keys_, settings_.delivery, welcome,
                                   *server, session.channel->encrypted(),
                                   {.order =
                                        [&session](const Delivery& order) {
                                          session.order = order;
                                          session.pinger.cancel();
                                        },
                                    .on_message =
                                        [this](const std::string& line) {
                                          if (events_.delivery) events_.delivery(line);
                                        }});
}

std::optional<WireError> Connection::handle(Session& session, Message message) {
  if (auto* const error = std::get_if<WireError>(&message)) return std::move(*error);
  const LocalTime now = clock_.now();
  std::optional<WireError> failure;
  if (const auto* const welcome = std::get_if<Welcome>(&message)) {
    failure = handleWelcome(session, *welcome);
  } else if (!session.welcomed) {
    failure = WireError{ErrorCode::kUnexpected, "the first message is not a welcome"};
  } else if (auto* const frame = std::get_if<CodedFrame>(&message)) {
    if (!session.first_frame) session.first_frame = now;
    if (session.link) session.link->tcpFrame(frame->id);
    receiver_.frame(std::move(*frame), now);
  } else if (const auto* const pong = std::get_if<Pong>(&message)) {
    handlePong(session, *pong);
  } else if (auto* const video = std::get_if<VideoFrame>(&message)) {
    if (events_.video) events_.video(std::move(*video));
  } else if (const auto* const preparing = std::get_if<Preparing>(&message)) {
    if (events_.preparing) events_.preparing(preparing->share);
  } else if (const auto* const key = std::get_if<DatagramKey>(&message)) {
    failure = handleKey(*key);
  } else if (const auto* const description = std::get_if<StreamDescription>(&message)) {
    session.description = *description;
    receiver_.describe(*description, now);
    if (events_.described) events_.described(*description);
  } else if (!std::holds_alternative<Control>(message) || !session.description.timeline) {
    // A control comes back; the description has its effect.
    failure = WireError{ErrorCode::kUnexpected, "the server sent a message that only clients send"};
  }
  session.deadline = now + settings_.silence_limit;
  session.overdue = "the server stopped sending";
  return failure;
}

std::optional<WireError> Connection::handleKey(const DatagramKey& key) {
  if (!keys_.sealed())
    return WireError{ErrorCode::kUnexpected, "a key of datagrams for a stream without them"};
  keys_.add(key, clock_.now());
  return std::nullopt;
}

void Connection::handlePong(Session& session, const Pong& pong) {
  // A pong counts only for a ping that was sent, and once.
  const auto requested = std::find(session.pings.begin(), session.pings.end(), pong.t0);
  if (requested == session.pings.end()) return;
  session.pings.erase(requested);
  session.unanswered_since.reset();
  receiver_.pong(pong, clock_.now());
}

ReceiverReport Connection::report() const {
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
