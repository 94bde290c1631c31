// SPDX-License-Identifier: MIT
#include "server/relay/relay_subscriber.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <variant>

namespace hapticast::server {

namespace {

constexpr std::size_t kMostPings = 64;  // without an answer; chosen
// How late a new viewer's request for pictures may reach the origin; each call costs 30 us.
constexpr Duration kPollEvery = RelaySubscriber::kPingEvery / 2;

EncodedFrame makeEncodedFrame(const RelayFrame& frame) {
  EncodedFrame encoded{frame.epoch, frame.id, frame.media_time, frame.delta, nullptr};
  encoded.key_frame =
      std::make_shared<LazyKeyFrame>(frame.key_frame ? frame.key_frame : frame.delta);
  encoded.datagrams = frame.datagrams;
  encoded.too_many_datagrams = frame.too_many_datagrams;
  return encoded;
}

}  // namespace

RelaySubscriber::RelaySubscriber(const NatsAddress& address, const NatsCredentials& credentials,
                                 std::vector<KeyBytes> keys, const Clock& clock,
                                 RelayClock& media_clock, Broadcaster& broadcaster)
    : clock_(clock),
      media_clock_(media_clock),
      broadcaster_(broadcaster),
      channel_(address.channel),
      subjects_(address.channel),
      inbox_(NatsConnection::makeInbox()),
      has_tls_(!credentials.ca_file.empty()),
      joiner_([this](auto begin) {
        return follower_.mayCount(begin, clock_.now(), std::chrono::system_clock::now());
      }),
      follower_(address.channel, std::move(keys)),
      nats_("--source", address, credentials) {
  nats_.subscribe(inbox_, [this](auto bytes, const auto&) { onPong(bytes); });
  nats_.subscribe(subjects_.everything, [this](auto bytes, const auto&) { onPiece(bytes); });
}

void RelaySubscriber::onPiece(std::span<const std::uint8_t> piece) {
  const std::lock_guard lock(mutex_);
  const auto whole = joiner_.add(piece);
  if (!whole.ok()) return logProblem(whole.error().message);
  if (!whole.value()) return;
  FollowedMessage message =
      follower_.onMessage(*whole.value(), clock_.now(), std::chrono::system_clock::now());
  if (!message.problem.empty()) logProblem(message.problem);
  if (!message.content) return;
  if (message.new_origin) onNewOrigin();
  if (const auto* const state = std::get_if<RelayState>(&*message.content)) onContent(*state);
  if (const auto* const frame = std::get_if<RelayFrame>(&*message.content)) onContent(*frame);
  if (const auto* const picture = std::get_if<RelayPicture>(&*message.content)) onContent(*picture);
}

void RelaySubscriber::logProblem(const std::string& problem) {
  if (const auto line = problems_.admit(
          "channel " + channel_ + ": a message was dropped: " + problem, clock_.now()))
    spdlog::warn("{}", *line);
}

void RelaySubscriber::onNewOrigin() {
  if (state_) spdlog::warn("channel {}: another origin sends from now on", channel_);
  clock_sync_.reset();
  pings_.clear();
  pongs_ = 0;
  next_ping_.reset();
  state_.reset();
  synchronised_ = false;
  last_frame_.reset();
  changed_.notify_all();
}

void RelaySubscriber::onContent(const RelayState& received) {
  last_state_ = clock_.now();
  RelayState state = received;
  if (state.datagram_key && !has_tls_) {
    if (!state_)
      spdlog::warn(
          "channel {}: viewers receive frames by TCP only; an edge uses the key of the sealed "
          "datagrams only with --nats-ca",
          channel_);
    state.datagram_key.reset();
  }
  const bool changed = !state_ || state_->description != state.description;
  const bool new_key = state_ && state.datagram_key && state_->datagram_key != state.datagram_key;
  state_ = state;
  if (changed && synchronised_) broadcaster_.describe(state.description);
  if (new_key && synchronised_) broadcaster_.changeKey(*state.datagram_key);
}

void RelaySubscriber::onContent(const RelayFrame& frame) {
  last_frame_ = makeEncodedFrame(frame);
  if (synchronised_) broadcaster_.publish(*last_frame_);
}

void RelaySubscriber::onContent(const RelayPicture& picture) {
  if (synchronised_)
    broadcaster_.publish(EncodedVideo{picture.id, picture.media_time, picture.message});
}

void RelaySubscriber::onPong(std::span<const std::uint8_t> piece) {
  const std::lock_guard lock(mutex_);
  const auto whole = RelayJoiner().add(piece);  // a pong has one piece
  if (!whole.ok() || !whole.value()) return;
  // A pong counts only for a ping that was sent to this origin, and once.
  const auto find = [this](LocalTime t0) { return std::find(pings_.begin(), pings_.end(), t0); };
  const auto pong = follower_.readPong(*whole.value(), std::chrono::system_clock::now(),
                                       [&](LocalTime t0) { return find(t0) != pings_.end(); });
  if (!pong) return;
  pings_.erase(find(pong->t0));
  ++pongs_;
  clock_sync_.add(pong->t0, pong->t1, pong->t2, clock_.now());
}

void RelaySubscriber::poll() {
  if (nats_.isClosed())
    throw std::runtime_error("--source: NATS has closed the connection and refuses a new one");
  const LocalTime now = clock_.now();
  std::unique_lock lock(mutex_);
  synchronise(now);
  logSilence(now);
  const auto ping = makePing(now);
  lock.unlock();
  if (ping) (void)nats_.publish(subjects_.pings, encodeRelayPing(*ping), inbox_);
  lock.lock();
  // A new origin ends the pause.
  const bool begins = state_ && pongs_ < ClockSync::kBurst;
  changed_.wait_for(lock, begins ? kBurstEvery / 2 : kPollEvery);
}

void RelaySubscriber::synchronise(LocalTime now) {
  if (!state_ || !clock_sync_.ready()) return;
  const Duration offset = clock_sync_.offset(now), error = clock_sync_.errorBound();
  if (synchronised_) return media_clock_.set(offset, error);
  synchronised_ = true;
  spdlog::info("channel {}: the origin's clock is known to {:.2f} ms", channel_,
               1e3 * toSeconds(error));
  broadcaster_.changeOrigin(
      {state_->stream, state_->verifying_key, state_->probe, state_->sealed, state_->datagram_key},
      state_->description, [&clock = media_clock_, offset, error] { clock.set(offset, error); });
  if (last_frame_) broadcaster_.publish(*last_frame_);
}

void RelaySubscriber::logSilence(LocalTime now) {
  const bool silent = last_state_ && now - *last_state_ > kSilence;
  if (silent == silent_ || !last_state_) return;
  silent_ = silent;
  if (silent) {
    spdlog::warn("channel {}: no origin sends; viewers stay connected and wait", channel_);
  } else {
    spdlog::info("channel {}: an origin sends again", channel_);
  }
}

std::optional<RelayPing> RelaySubscriber::makePing(LocalTime now) {
  const bool pictures = broadcaster_.videoWanted();
  const bool datagrams = broadcaster_.datagramsWanted();
  const bool more = (pictures && !wanted_pictures_) || (datagrams && !wanted_datagrams_);
  wanted_pictures_ = pictures;
  wanted_datagrams_ = datagrams;
  if (!state_ || (next_ping_ && now < *next_ping_ && !more)) return std::nullopt;
  next_ping_ = now + (pongs_ < ClockSync::kBurst ? kBurstEvery : kPingEvery);
  pings_.push_back(now);
  if (pings_.size() > kMostPings) pings_.pop_front();
  return RelayPing{now, pictures, datagrams, follower_.popProof()};
}

RelayCounts RelaySubscriber::counts() const {
  const bool connected = nats_.isConnected();
  const std::lock_guard lock(mutex_);
  const bool active = synchronised_ && last_state_ && clock_.now() - *last_state_ <= kSilence;
  return {true, connected, active, follower_.term(), last_state_};
}

std::optional<StreamDescription> RelaySubscriber::description() const {
  const std::lock_guard lock(mutex_);
  if (!synchronised_) return std::nullopt;
  return state_->description;
}

}  // namespace hapticast::server
