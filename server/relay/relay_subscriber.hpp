// SPDX-License-Identifier: MIT
// Receives the stream of a channel's active origin from NATS and passes it to a broadcaster, with
// all encoded bytes unchanged. It pings the origin and synchronises the edge's media clock with
// that of the origin. It reads each message from the queue of libnats at once. So only the viewers'
// queues drop frames, and these drop the oldest. Thread: see each function.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/protocol/relay.hpp"
#include "common/rate_limiter.hpp"
#include "common/transport/clock_sync.hpp"
#include "server/relay/nats_connection.hpp"
#include "server/relay/origin_follower.hpp"
#include "server/relay/relay_clock.hpp"
#include "server/relay/relay_counts.hpp"
#include "server/relay/subjects.hpp"
#include "server/stream/broadcaster.hpp"

namespace hapticast::server {

/// An edge of one channel, without its viewers.
class RelaySubscriber {
 public:
  /// Interval of pings (kPingEvery), and of the first pings to an origin (kBurstEvery).
  static constexpr Duration kPingEvery = std::chrono::milliseconds(250);
  static constexpr Duration kBurstEvery = std::chrono::milliseconds(20);
  /// Time without a state message after which the log has a warning. A takeover is shorter.
  static constexpr Duration kSilence = std::chrono::seconds(2);

  /// Connects to NATS and subscribes to the channel. `keys`: verifying keys that an origin may
  /// have; empty: any key. `broadcaster` receives the items of the active origin in the threads of
  /// libnats, from the moment when the clock is synchronised. Throws as NatsConnection does.
  /// `clock`, `media_clock` and `broadcaster` must outlive this object. Thread: that of poll().
  RelaySubscriber(const NatsAddress& address, const NatsCredentials& credentials,
                  std::vector<KeyBytes> keys, const Clock& clock, RelayClock& media_clock,
                  Broadcaster& broadcaster);

  /// Sends pings, updates the media clock, and completes the change to a new origin. Blocks until
  /// the next call is due, for at most 125 ms. Throws std::runtime_error if NATS refuses the
  /// connection for good. Thread: one.
  void poll();
  /// Returns the description of the stream once the clock is synchronised; nullopt before. Thread:
  /// the one of poll().
  [[nodiscard]] std::optional<StreamDescription> description() const;
  /// Returns the state of this edge. Thread: any.
  [[nodiscard]] RelayCounts counts() const;

 private:
  void onPiece(std::span<const std::uint8_t> piece);
  void onPong(std::span<const std::uint8_t> piece);
  void onContent(const RelayState& received);
  void onContent(const RelayFrame& frame);
  void onContent(const RelayPicture& picture);
  void onNewOrigin();
  void logProblem(const std::string& problem);
  void logSilence(LocalTime now);
  void synchronise(LocalTime now);
  [[nodiscard]] std::optional<RelayPing> makePing(LocalTime now);

  const Clock& clock_;
  RelayClock& media_clock_;
  Broadcaster& broadcaster_;
  std::string channel_;
  Subjects subjects_;
  std::string inbox_;
  bool has_tls_;              // of this edge's connection to NATS
  mutable std::mutex mutex_;  // guards all members below but nats_
  std::condition_variable changed_;
  RelayJoiner joiner_;
  OriginFollower follower_;
  ClockSync clock_sync_;
  std::deque<LocalTime> pings_;  // not answered yet
  std::size_t pongs_ = 0;        // of this origin
  std::optional<LocalTime> next_ping_;
  bool wanted_pictures_ = false;
  bool wanted_datagrams_ = false;
  std::optional<RelayState> state_;         // of the followed origin
  bool synchronised_ = false;               // with the origin of state_
  std::optional<EncodedFrame> last_frame_;  // until the clock is synchronised
  std::optional<LocalTime> last_state_;
  bool silent_ = false;
  RateLimiter problems_;
  NatsConnection nats_;  // last member: its callbacks use all others
};

}  // namespace hapticast::server
