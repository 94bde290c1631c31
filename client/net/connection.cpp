// SPDX-License-Identifier: MIT
#include "client/net/connection.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

namespace {

constexpr auto kCheckEvery = std::chrono::milliseconds(50);

}  // namespace

struct Connection::Sockets {
  Sockets(asio::io_context& io, std::unique_ptr<Channel> over)
      : channel(std::move(over)), sender(io), watcher(io) {}

  void close() {
    closed = true;
    if (datagrams) datagrams->close();
    channel->close();
    sender.cancel();
    watcher.cancel();
  }

  std::unique_ptr<Channel> channel;
  std::shared_ptr<UdpReceiver> datagrams;  // null: frames arrive over TCP only
  asio::steady_timer sender;
  asio::steady_timer watcher;
  LocalTime next_message{};  // for which the sender waits
  bool closed = false;
  std::optional<SessionEnd> expired;  // the time limit that closed the sockets
};

Connection::Connection(asio::io_context& io, const Clock& clock, ConnectionSettings settings,
                       Receiver& receiver, ConnectionEvents events)
    : io_(io),
      clock_(clock),
      settings_(std::move(settings)),
      receiver_(receiver),
      events_(std::move(events)),
      retry_(io),
      session_(settings_, &receiver) {}

void Connection::start() {
  asio::co_spawn(
      io_, [this] { return run(); }, asio::detached);
}

void Connection::stop() {
  asio::post(io_, [this] {
    stopped_ = true;
    retry_.cancel();
    dial_stop_.stop();
    if (sockets_) sockets_->close();
  });
}

std::uint64_t Connection::bytesReceived() const {
  if (!sockets_) return bytes_received_;
  return bytes_received_ + sockets_->channel->bytesRead() +
         (sockets_->datagrams ? sockets_->datagrams->bytesReceived() : 0);
}

DatagramCounts Connection::datagrams() const {
  return sockets_ && sockets_->datagrams ? datagrams_ + sockets_->datagrams->counts() : datagrams_;
}

DeliveryStats Connection::delivery() const {
  return sockets_ && sockets_->datagrams ? sockets_->datagrams->state() : delivery_;
}

asio::awaitable<void> Connection::run() {
  while (!stopped_) {
    const SessionEnd end = co_await runSession();
    bytes_received_ = bytesReceived();
    datagrams_ = datagrams();
    delivery_ = delivery();
    sockets_.reset();
    const auto pause = session_.close(end, clock_.now());
    if (stopped_) break;
    if (!pause) {
      if (events_.failed) events_.failed(end.why);
      co_return;
    }
    if (end.code == ErrorCode::kShuttingDown && events_.goodbye) events_.goodbye();
    if (events_.disconnected) events_.disconnected(end.why);
    retry_.expires_after(*pause);
    boost::system::error_code ec;
    co_await retry_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
  }
  receiver_.disconnected(clock_.now());
}

asio::awaitable<SessionEnd> Connection::runSession() {
  Dialled dialled =
      co_await settings_.dial(io_, settings_.server, settings_.connect_deadline, dial_stop_);
  if (!dialled.ok())
    co_return SessionEnd{.why = dialled.error().message,
                         .untrusted = dialled.error().untrusted,
                         .no_such_server = dialled.error().no_such_server};
  const Channel& channel = *dialled.value();
  if (auto refusal = session_.open({channel.encrypted(), channel.ofThisMachine()}, clock_.now()))
    co_return std::move(*refusal);
  auto sockets = sockets_ = std::make_shared<Sockets>(io_, std::move(dialled).value());
  asio::co_spawn(
      io_, [this, sockets] { return watch(sockets); }, asio::detached);
  asio::co_spawn(
      io_, [this, sockets] { return writeLoop(sockets); }, asio::detached);
  SessionEnd end = co_await readAll(sockets);
  sockets->close();
  co_return end;
}

asio::awaitable<void> Connection::watch(SocketsPtr sockets) {
  while (!sockets->closed) {
    sockets->expired = session_.expire(clock_.now());
    if (sockets->expired) co_return sockets->close();
    boost::system::error_code cancelled;
    const Duration left = session_.nextDeadline() - clock_.now();
    sockets->watcher.expires_after(std::min<Duration>(left, kCheckEvery));
    co_await sockets->watcher.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
  }
}

asio::awaitable<void> Connection::writeLoop(SocketsPtr sockets) {
  while (!sockets->closed) {
    if (const auto message = session_.poll(clock_.now())) {
      if (!co_await sockets->channel->write(encodeShared(*message))) co_return;
    } else {
      boost::system::error_code woken;
      sockets->next_message = session_.nextMessage();
      sockets->sender.expires_after(
          std::min<Duration>(sockets->next_message - clock_.now(), settings_.ping_interval));
      co_await sockets->sender.async_wait(asio::redirect_error(asio::use_awaitable, woken));
    }
  }
}

void Connection::control(const Control& control) {
  if (!sockets_ || !session_.description().timeline || !session_.request(control)) return;
  sockets_->sender.cancel();
}

asio::awaitable<SessionEnd> Connection::readAll(SocketsPtr sockets) {
  for (;;) {
    const auto payload = co_await sockets->channel->read();
    if (sockets->expired) co_return std::move(*sockets->expired);
    if (!payload.ok()) co_return SessionEnd{payload.error().message, payload.error().code};
    if (!payload.value())
      co_return SessionEnd{"the connection was lost (" + sockets->channel->whyEnded() + ")"};
    auto message = session_.receive(*payload.value(), clock_.now());
    if (!message.ok()) co_return message.error();
    handle(*sockets, std::move(message).value());
    if (session_.nextMessage() < sockets->next_message) sockets->sender.cancel();
  }
}

void Connection::handle(Sockets& sockets, Message message) {
  if (const auto* const welcome = std::get_if<Welcome>(&message)) {
    onWelcome(sockets, *welcome);
  } else if (const auto* const frame = std::get_if<CodedFrame>(&message)) {
    if (sockets.datagrams) sockets.datagrams->tcpFrame(frame->id);
  } else if (auto* const video = std::get_if<VideoFrame>(&message)) {
    if (events_.video) events_.video(std::move(*video));
  } else if (const auto* const preparing = std::get_if<Preparing>(&message)) {
    if (events_.preparing) events_.preparing(preparing->share);
  } else if (const auto* const key = std::get_if<DatagramKey>(&message)) {
    keys_.add(*key, clock_.now());
  } else if (const auto* const description = std::get_if<StreamDescription>(&message)) {
    if (events_.described) events_.described(*description);
  }
}

void Connection::onWelcome(Sockets& sockets, const Welcome& welcome) {
  if (session_.welcomes() > 1) closeDatagrams(sockets);
  keys_.begin(welcome.datagram_key);
  sockets.channel->setReadLimit(session_.readLimit());
  if (session_.isDescriptionNew() && events_.welcomed) events_.welcomed(welcome.description);
  openDatagrams(sockets, welcome);
  sockets.sender.cancel();  // the first ping is due
}

void Connection::closeDatagrams(Sockets& sockets) {
  if (sockets.datagrams) {
    bytes_received_ += sockets.datagrams->bytesReceived();
    datagrams_ = datagrams();
    delivery_ = {};
    sockets.datagrams->close();
    sockets.datagrams.reset();
    session_.request(Delivery{});  // replaces a request that is under way to the server
  }
  if (events_.delivery) events_.delivery("another server makes the stream from now on");
}

void Connection::openDatagrams(Sockets& sockets, const Welcome& welcome) {
  const auto server = parseEndpoint(sockets.channel->peer(), {});
  if (!server) return;  // a channel that is no connection between hosts
  // The sockets close the datagrams before their own end.
  sockets.datagrams = UdpReceiver::open(io_, clock_, receiver_, keys_, settings_.delivery, welcome,
                                        *server, sockets.channel->encrypted(),
                                        {.order =
                                             [this, &sockets](const Delivery& delivery) {
                                               session_.request(delivery);
                                               sockets.sender.cancel();
                                             },
                                         .on_message =
                                             [this](const std::string& line) {
                                               if (events_.delivery) events_.delivery(line);
                                             }});
}

}  // namespace hapticast::client
