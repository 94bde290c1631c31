// SPDX-License-Identifier: MIT
#include "client/net/udp/udp_receiver.hpp"

#include <algorithm>
#include <utility>

namespace hapticast::client {

namespace {

// Chosen: bounds the delay of the first datagram after a lost echo or probe.
constexpr Duration kEchoUntilProbed = std::chrono::milliseconds(200);
constexpr Duration kEchoEvery = std::chrono::seconds(10);  // keeps firewalls and NAT open
constexpr Duration kTurn = std::chrono::milliseconds(20);
// Chosen: with more unverified datagrams in a second, the server's own datagrams drown in a flood.
constexpr std::uint64_t kFlood = 400;
// Chosen: no network produces invalid signatures. 100 verifications cost 10 ms. On a busy machine
// the verification itself would drown the server's datagrams.
constexpr std::uint64_t kForgedFlood = 100;

std::vector<Transport> listTransports(const DeliverySettings& settings, const Welcome& welcome) {
  std::vector<Transport> transports;
  if (settings.best == Transport::kGroup && welcome.group) transports.push_back(Transport::kGroup);
  if (settings.best != Transport::kTcp) transports.push_back(Transport::kDatagrams);
  transports.push_back(Transport::kTcp);
  return transports;
}

}  // namespace

std::shared_ptr<UdpReceiver> UdpReceiver::open(asio::io_context& io, const Clock& clock,
                                               Receiver& receiver, DatagramKeyRing& keys,
                                               const DeliverySettings& settings,
                                               const Welcome& welcome, const Endpoint& server,
                                               bool encrypted, Events events) {
  if (settings.best == Transport::kTcp) return nullptr;
  if (welcome.datagram_token == 0 || !welcome.verifying_key) {
    events.on_message(
        encrypted
            ? "this server sends no datagrams: the client receives frames over TCP"
            : "this server sends no datagrams to this client, which receives frames over TCP; a "
              "server with TLS sends them to hapticasts://HOST only");
    return nullptr;
  }
  if (settings.best == Transport::kGroup && !welcome.group)
    events.on_message("this server sends to no multicast group: the client receives frames by UDP");
  std::shared_ptr<UdpReceiver> link(
      new UdpReceiver(io, clock, receiver, keys, settings, welcome, server, std::move(events)));
  link->start();
  return link;
}

UdpReceiver::UdpReceiver(asio::io_context& io, const Clock& clock, Receiver& receiver,
                         DatagramKeyRing& keys, const DeliverySettings& settings,
                         const Welcome& welcome, const Endpoint& server, Events events)
    : io_(io),
      clock_(clock),
      receiver_(receiver),
      keys_(keys),
      settings_(settings),
      welcome_(welcome),
      server_(server),
      events_(std::move(events)),
      timer_(io),
      choice_(listTransports(settings, welcome)),
      copies_(settings.copies > 0 ? settings.copies : LossEstimator::kFirstCopies),
      meter_(copies_, settings.copies > 0) {
  if (welcome_.datagram_port != 0) server_.port = welcome_.datagram_port;
}

void UdpReceiver::start() {
  update(clock_.now());
  asio::co_spawn(
      io_, [self = shared_from_this()] { return self->startTimer(); }, asio::detached);
}

void UdpReceiver::close() {
  closed_ = true;
  timer_.cancel();
  if (path_) path_->close();
}

asio::awaitable<void> UdpReceiver::startTimer() {
  while (!closed_) {
    const LocalTime now = clock_.now();
    const LocalTime due = receiver_.nextDue().value_or(now + kTurn);
    boost::system::error_code ec;
    timer_.expires_after(std::clamp<Duration>(due - now, Duration{0}, kTurn));
    co_await timer_.async_wait(asio::redirect_error(asio::use_awaitable, ec));
    if (closed_) co_return;
    receiver_.release(clock_.now());
    update(clock_.now());
  }
}

const char* UdpReceiver::flood(LocalTime now) {
  if (!path_) return nullptr;
  const DatagramCounts& counts = path_->counts();
  if (counts.forged - counted_.forged > kForgedFlood) return "somebody forges datagrams";
  if (counts.over_budget - counted_.over_budget > kFlood)
    return "more datagrams arrive than the client can verify";
  // The counters restart only after their check.
  if (now - counted_at_ >= std::chrono::seconds(1)) {
    counted_at_ = now;
    counted_ = counts;
  }
  return nullptr;
}

void UdpReceiver::reportUnopened(LocalTime now) {
  const std::uint64_t unopened = counts().not_opened;
  if (unopened == reported_unopened_ || !unopened_interval_.isReady(now)) return;
  events_.on_message(std::to_string(unopened - reported_unopened_) +
                     " datagrams were dropped: their key is unknown or has expired, or they are "
                     "not sealed as this stream is");
  reported_unopened_ = unopened;
  (void)unopened_interval_.allow(now);
}

void UdpReceiver::update(LocalTime now) {
  reportUnopened(now);
  if (const char* const why = flood(now)) choice_.markFailed(why, now);
  copies_ = meter_.copies(now);
  choice_.update(now, copies_, receiver_.stream().frame_interval);
  receiver_.expectCopies(choice_.works() ? copies_ : 1, now);
  applySelection(now);
  const Duration pause = choice_.wasProbed() ? kEchoEvery : kEchoUntilProbed;
  if (opened_ == Transport::kDatagrams && path_ && (!echoed_at_ || now - *echoed_at_ >= pause)) {
    echoed_at_ = now;
    path_->send(echoBytes({welcome_.datagram_token, welcome_.stream}));
  }
  if (const auto order = choice_.takeRequest()) events_.order(*order);
  if (const auto news = choice_.nextMessage()) events_.on_message(*news);
}

void UdpReceiver::applySelection(LocalTime now) {
  while (opened_ != choice_.transport()) {
    if (path_) {
      counts_ = counts();
      bytes_ = bytesReceived();
      path_->close();
      path_.reset();
    }
    const Transport transport = choice_.transport();
    opened_ = transport;
    echoed_at_.reset();
    if (transport == Transport::kTcp) return;
    auto key = VerifyingKey::from(*welcome_.verifying_key);
    if (!key.ok()) return choice_.markFailed(key.error().message, now);
    const bool group = transport == Transport::kGroup;
    DatagramVerifier verifier(group ? welcome_.group->token : welcome_.datagram_token,
                              welcome_.stream, std::move(key).value(), keys_);
    auto path =
        group ? UdpSocket::ofGroup(io_, clock_, {welcome_.group->address, welcome_.group->port},
                                   settings_.interface_name, server_, std::move(verifier))
              : UdpSocket::toServer(io_, clock_, server_, std::move(verifier));
    if (!path.ok()) {
      choice_.markFailed(path.error().message, now);
      continue;
    }
    path_ = std::move(path).value();
    counted_ = {};
    path_->start(
        [this](const DatagramHeader& header) {
          const FrameAssembler::Want want = receiver_.classify(header);
          if (want == FrameAssembler::Want::kHad) meter_.onDuplicate(header);
          return want;
        },
        [this, transport](const Datagram& datagram, LocalTime at) {
          onDatagram(transport, datagram, at);
        });
  }
}

void UdpReceiver::onDatagram(Transport transport, const Datagram& datagram, LocalTime now) {
  if (closed_ || transport != choice_.transport()) return;
  if (datagram.header.probe()) return choice_.probed();
  meter_.add(datagram.header);
  if (receiver_.part(datagram.header, datagram.payload, now)) {
    choice_.onCompleteFrame(datagram.header.frame, now);
  }
}

void UdpReceiver::tcpFrame(std::uint64_t id) { choice_.tcpFrame(id, clock_.now()); }

DatagramCounts UdpReceiver::counts() const { return path_ ? counts_ + path_->counts() : counts_; }

DeliveryStats UdpReceiver::state() const {
  return {choice_.works() ? choice_.transport() : Transport::kTcp, meter_.loss(), copies_};
}

std::uint64_t UdpReceiver::bytesReceived() const {
  return bytes_ + (path_ ? path_->bytesReceived() : 0);
}

}  // namespace hapticast::client
