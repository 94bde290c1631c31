// SPDX-License-Identifier: MIT
// Publishes the stream of this server on NATS, for edges (--publish). A separate thread sends, so a
// slow NATS server does not delay the encoder. If frames wait, newer ones replace the oldest. While
// another origin of the channel is active, this origin sends nothing (OriginElection). Thread: see
// each function.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/protocol/relay.hpp"
#include "common/rate_limiter.hpp"
#include "server/relay/election_messages.hpp"
#include "server/relay/nats_connection.hpp"
#include "server/relay/origin_election.hpp"
#include "server/relay/ping_limiter.hpp"
#include "server/relay/relay_counts.hpp"
#include "server/relay/subjects.hpp"
#include "server/stream/frame_signer.hpp"
#include "server/stream/stream_sink.hpp"

namespace hapticast::server {

/// An origin of one channel.
class RelayPublisher final : public StreamSink {
 public:
  /// Connects to NATS and begins as a standby. `keys`: verifying keys of the channel's origins. The
  /// publisher ignores heartbeats with other keys. Empty: any key is valid. Throws as
  /// NatsConnection does. The clocks and `signer` must outlive this object.
  RelayPublisher(const NatsAddress& address, const NatsCredentials& credentials, const Clock& clock,
                 const MediaClock& media_clock, FrameSigner& signer, std::vector<KeyBytes> keys);
  /// Ends the thread and the connection.
  ~RelayPublisher() override;

  void describe(const StreamDescription& description) override;
  /// Sends the key to edges with the next state. Does nothing if the connection to NATS has no TLS.
  void changeKey(const DatagramKey& key) override;
  void publish(EncodedFrame frame) override;
  void publish(EncodedVideo video) override;
  /// Return whether an edge requested pictures or datagrams in the last seconds. datagramsWanted()
  /// is false if edges do not receive the key of sealed datagrams. Thread: any.
  [[nodiscard]] bool videoWanted() const override { return isRecent(pictures_wanted_ns_); }
  [[nodiscard]] bool datagramsWanted() const override {
    return shares_datagrams_ && isRecent(datagrams_wanted_ns_);
  }
  /// Returns the state of this origin. Thread: any.
  [[nodiscard]] RelayCounts counts() const;

 private:
  /// Items that wait for the thread. Newer ones replace older ones.
  struct Waiting {
    std::deque<EncodedFrame> frames;
    std::optional<EncodedVideo> picture;
    bool state = false;  ///< the description or the key is new
  };
  void run(const std::stop_token& stop);
  /// Updates the election. Returns the head of the next message if this origin is active.
  [[nodiscard]] std::optional<RelayHead> checkElection(LocalTime now);
  void send(const Waiting& items, RelayHead head, LocalTime now);
  void sendContent(const std::string& subject, RelayHead& head, const RelayContent& content);
  void onHeartbeat(std::span<const std::uint8_t> bytes);
  void onPing(std::span<const std::uint8_t> bytes, const std::string& reply);
  void logUnansweredPing(LocalTime now);
  [[nodiscard]] bool isRecent(const std::atomic<std::int64_t>& time_ns) const;

  const Clock& clock_;
  const MediaClock& media_clock_;
  FrameSigner& signer_;
  bool shares_datagrams_;  // false: they are sealed, and their key may not travel to edges
  std::string channel_;
  Subjects subjects_;
  std::atomic<std::int64_t> pictures_wanted_ns_;  // local time of the last request
  std::atomic<std::int64_t> datagrams_wanted_ns_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  OriginElection election_;                       // guarded by mutex_
  ElectionMessages messages_;                     // guarded by mutex_
  std::optional<StreamDescription> description_;  // guarded by mutex_
  std::optional<DatagramKey> datagram_key_;       // newest one for edges; guarded by mutex_
  Waiting waiting_;                               // guarded by mutex_
  std::uint64_t number_ = 0;                      // of the last message; guarded by mutex_
  RateLimiter distrusted_ = RateLimiter::makeOnceAMinute();  // guarded by mutex_
  std::optional<bool> logged_active_;                        // used by the thread only
  std::optional<LocalTime> heartbeat_;                       // last own one; guarded by mutex_
  RateLimiter too_large_ = RateLimiter::makeOnceAMinute();   // used by the thread only
  PingLimiter ping_limiter_;                                 // used by the thread of pings only
  RateLimiter unanswered_ = RateLimiter::makeOnceAMinute();  // used by the thread of pings only
  NatsConnection nats_;
  std::jthread thread_;  // last member: it uses all others
};

}  // namespace hapticast::server
