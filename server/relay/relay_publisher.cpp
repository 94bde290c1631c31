// SPDX-License-Identifier: MIT
#include "server/relay/relay_publisher.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "server/stream/send_queue.hpp"

namespace hapticast::server {

namespace {

// Edges ping once a second; two pings may be lost.
constexpr Duration kWantedFor = std::chrono::seconds(3);
// The head of a NATS message and its subject count, too: libnats and the server check the payload
// only, but an operator may set a limit that leaves no more room.
constexpr std::size_t kMostPiece_bytes = 512U << 10U;

/// Returns the random number of this origin. Its low 32 bits are the stream's.
std::uint64_t numberOrigin(std::uint32_t stream) {
  return (makeUnguessable() & ~std::uint64_t{0xFFFFFFFF}) | stream;
}

/// Seconds since 1970: later origins have higher terms.
std::uint64_t leastTerm() {
  return static_cast<std::uint64_t>(std::max<std::time_t>(0, std::time(nullptr)));
}

RelayFrame relayFrame(const EncodedFrame& frame, bool with_datagrams) {
  RelayFrame relayed{frame.epoch, frame.id, frame.media_time,        frame.delta,
                     nullptr,     nullptr,  frame.too_many_datagrams};
  if (with_datagrams) relayed.datagrams = frame.datagrams;
  if (SharedBytes key = frame.key_frame->payload(); key != frame.delta)
    relayed.key_frame = std::move(key);
  return relayed;
}

}  // namespace

RelayPublisher::RelayPublisher(const NatsAddress& address, const NatsCredentials& credentials,
                               const Clock& clock, const MediaClock& media_clock,
                               FrameSigner& signer, std::vector<KeyBytes> keys)
    : clock_(clock),
      media_clock_(media_clock),
      signer_(signer),
      shares_datagrams_(!signer.identity().sealed || !credentials.ca_file.empty()),
      channel_(address.channel),
      subjects_(address.channel),
      pictures_wanted_ns_((clock.now() - kWantedFor).time_since_epoch().count()),
      datagrams_wanted_ns_(pictures_wanted_ns_.load()),
      election_(numberOrigin(signer.identity().stream), leastTerm(), clock.now()),
      messages_(channel_, std::move(keys), election_),
      nats_("--publish", address, credentials) {
  number_ = election_.origin() / 2;  // random: no piece fits a message of another origin
  if (shares_datagrams_) datagram_key_ = signer.identity().datagram_key;
  if (!shares_datagrams_)
    spdlog::warn(
        "--publish: viewers of edges receive frames by TCP only; the key of the sealed datagrams "
        "travels only with --nats-ca");
  nats_.subscribe(subjects_.state, [this](auto bytes, const auto&) { onHeartbeat(bytes); });
  nats_.subscribe(subjects_.pings, [this](auto bytes, const auto& reply) { onPing(bytes, reply); });
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

RelayPublisher::~RelayPublisher() = default;

void RelayPublisher::describe(const StreamDescription& description) {
  const std::lock_guard lock(mutex_);
  description_ = description;
  waiting_ = {};
  waiting_.state = true;
  changed_.notify_all();
}

void RelayPublisher::changeKey(const DatagramKey& key) {
  if (!shares_datagrams_) return;
  const std::lock_guard lock(mutex_);
  datagram_key_ = key;
  waiting_.state = true;  // the state leaves before the frames, which may need the key
  changed_.notify_all();
}

void RelayPublisher::publish(EncodedFrame frame) {
  const std::lock_guard lock(mutex_);
  auto& frames = waiting_.frames;
  while (!frames.empty() && (frames.size() >= SendQueue::kMaxFrames ||
                             frames.front().media_time + SendQueue::kMaxAge < frame.media_time))
    frames.pop_front();
  frames.push_back(std::move(frame));
  changed_.notify_all();
}

void RelayPublisher::publish(EncodedVideo video) {
  const std::lock_guard lock(mutex_);
  waiting_.picture = std::move(video);
  changed_.notify_all();
}

RelayCounts RelayPublisher::counts() const {
  const bool connected = nats_.isConnected();
  const std::lock_guard lock(mutex_);
  const bool active = election_.active();
  return {false, connected, active, election_.term(), active ? heartbeat_ : election_.heardAt()};
}

bool RelayPublisher::isRecent(const std::atomic<std::int64_t>& time_ns) const {
  return clock_.now().time_since_epoch().count() - time_ns.load(std::memory_order_relaxed) <
         kWantedFor.count();
}

void RelayPublisher::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    Waiting items;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, stop, OriginElection::kHeartbeat / 2, [this] {
        return !waiting_.frames.empty() || waiting_.picture || waiting_.state;
      });
      items = std::exchange(waiting_, {});
    }
    const LocalTime now = clock_.now();
    if (const auto head = checkElection(now)) send(items, *head, now);
  }
}

std::optional<RelayHead> RelayPublisher::checkElection(LocalTime now) {
  const bool connected = nats_.isConnected();
  const std::lock_guard lock(mutex_);
  if (!connected) election_.onDisconnected(now);
  // An origin whose clip is still scanned has nothing to send, so it does not take over.
  const bool active = description_ && election_.check(now);
  if (active && logged_active_ != true) {
    spdlog::info("origin of the channel {}: active (term {})", channel_, election_.term());
    signer_.revokeKey();  // datagrams that it made before must not be valid again
    logged_active_ = true;
  } else if (!active && logged_active_ != false && election_.heardAt()) {
    spdlog::warn("origin of the channel {}: standby, because another origin is active", channel_);
    logged_active_ = false;
  }
  if (!active || !connected) return std::nullopt;
  return RelayHead{election_.term(), election_.origin(), number_};
}

void RelayPublisher::send(const Waiting& items, RelayHead head, LocalTime now) {
  if (items.state || !heartbeat_ || now - *heartbeat_ >= OriginElection::kHeartbeat) {
    std::unique_lock lock(mutex_);
    heartbeat_ = now;
    const StreamIdentity& identity = signer_.identity();
    const RelayState state{*description_,  identity.stream, identity.verifying_key,
                           identity.probe, identity.sealed, datagram_key_};
    lock.unlock();
    sendContent(subjects_.state, head, state);
  }
  for (const EncodedFrame& frame : items.frames)
    sendContent(subjects_.frames, head, relayFrame(frame, shares_datagrams_));
  if (!items.picture) return;
  const EncodedVideo& picture = *items.picture;
  sendContent(subjects_.frames, head,
              RelayPicture{picture.id, picture.media_time, picture.payload});
}

void RelayPublisher::sendContent(const std::string& subject, RelayHead& head,
                                 const RelayContent& content) {
  {
    const std::lock_guard lock(mutex_);
    head.number = ++number_;
  }
  const auto whole =
      encodeRelay(channel_, head, content, [this](auto bytes) { return signer_.sign(bytes); });
  const auto pieces =
      splitRelay(whole, head.number, std::min(kMostPiece_bytes, nats_.maxPayload()));
  if (pieces.empty() && too_large_.allow(clock_.now())) {
    spdlog::warn(
        "a frame of {} kB is too large for NATS: the server leaves it out; max_payload is {} kB",
        whole.size() / 1000, nats_.maxPayload() / 1000);
  }
  for (const auto& piece : pieces) {
    if (!nats_.publish(subject, piece)) return;  // the edges drop an incomplete message
  }
}

void RelayPublisher::onHeartbeat(std::span<const std::uint8_t> bytes) {
  const LocalTime now = clock_.now();
  const auto whole = RelayJoiner().add(bytes);  // a heartbeat has one piece
  if (!whole.ok() || !whole.value()) return;
  const std::lock_guard lock(mutex_);
  const std::string problem =
      messages_.onHeartbeat(*whole.value(), now, std::chrono::system_clock::now());
  if (!problem.empty() && distrusted_.allow(now))
    spdlog::warn("origin of the channel {}: it ignores heartbeats: {}", channel_, problem);
}

void RelayPublisher::onPing(std::span<const std::uint8_t> bytes, const std::string& reply) {
  const MediaTime received = media_clock_.now();
  const LocalTime now = clock_.now();
  const auto ping = decodeRelayPing(bytes);
  if (!PingLimiter::isInbox(reply) || !ping.ok()) return logUnansweredPing(now);
  const std::int64_t now_ns = now.time_since_epoch().count();  // a flood hides no edge's needs
  if (ping.value().wants_pictures) pictures_wanted_ns_ = now_ns;
  if (ping.value().wants_datagrams) datagrams_wanted_ns_ = now_ns;
  if (!ping_limiter_.admit(reply, now)) return logUnansweredPing(now);
  RelayHead head;
  {
    const std::lock_guard lock(mutex_);
    if (!ping.value().proof.empty())
      messages_.onProof(ping.value().proof, now, std::chrono::system_clock::now());
    if (!election_.active()) return;
    head = {election_.term(), election_.origin(), number_};
  }
  const auto whole =
      encodeRelay(channel_, head, RelayPong{ping.value().t0, received, media_clock_.now()},
                  [this](auto each) { return signer_.sign(each); });
  const auto pieces = splitRelay(whole, 0, kMaxSmallMessageBytes);
  if (!pieces.empty()) nats_.publish(reply, pieces.front());
}

void RelayPublisher::logUnansweredPing(LocalTime now) {
  if (!unanswered_.allow(now)) return;
  spdlog::warn(
      "origin of the channel {}: a program sends too many pings, or pings that are not valid; the "
      "origin does not answer them ({} more since the last line)",
      channel_, unanswered_.popDropped());
}

}  // namespace hapticast::server
