// SPDX-License-Identifier: MIT
// Decides which origin of a channel an edge follows: the one with the highest (term, origin). It
// verifies the signature of each message with the key of its origin, and drops messages of other
// origins, of earlier terms, and messages out of order or again. What a number decides comes before
// the signature, because a signature costs 70 us. So after a takeover it drops all messages of the
// old origin. It leaves an origin that still sends at most once a minute, so that rivals
// cannot disturb viewers more often. If any key is valid, anybody can send the highest term once,
// so a silent origin then loses its rank. The class has no threads and no clock. Thread: one.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/protocol/relay.hpp"
#include "common/rate_limiter.hpp"
#include "common/transport/signature.hpp"
#include "server/relay/seen_numbers.hpp"

namespace hapticast::server {

/// A state of an origin, and the verifying key of its signature.
struct TrustedState {
  RelayState state;
  VerifyingKey key;
};
/// Returns the state in the whole message `whole` with the head `head`. Returns an error if its
/// signature does not match the key in the state, or if `keys` is not empty and lacks this key. If
/// the message has other content than a state, the text of the error is empty. Requires
/// readRelayHead() to succeed. Thread: any.
[[nodiscard]] Result<TrustedState> readTrustedState(const RelayHead& head,
                                                    std::span<const std::uint8_t> whole,
                                                    const std::vector<KeyBytes>& keys);

/// Returns a limiter of checks of signatures: 2,000 a second. Chosen: four times what an origin
/// sends at 240 frames/s, and a seventh of a core.
[[nodiscard]] inline RateLimiter makeCheckLimiter() {
  return {1000, std::chrono::microseconds(500)};
}
inline constexpr const char* kTooManyMessages =
    "more messages arrive in a second than an origin sends";

/// Result of OriginFollower::onMessage().
struct FollowedMessage {
  /// Content of a valid message of the followed origin; nullopt: the edge drops the message.
  std::optional<RelayContent> content;
  bool new_origin = false;  ///< the content is the first state of another origin
  /// Reason why the message was dropped, for the log. Empty if it was not dropped, or if another
  /// origin than the followed one sent it, which is normal.
  std::string problem;
};

/// The origin that one edge follows.
class OriginFollower {
 public:
  /// Silence after which an origin loses its rank, if any key is valid; chosen.
  static constexpr Duration kLoseRankAfter = std::chrono::seconds(3);

  /// `keys`: the only verifying keys that an origin may have; empty: any key.
  OriginFollower(std::string channel, std::vector<KeyBytes> keys)
      : channel_(std::move(channel)), keys_(std::move(keys)) {}

  /// Processes a whole message of the channel, the result of RelayJoiner. `now`, `utc`: the time of
  /// its arrival, by two clocks. A pong is none: it has a way of its own.
  FollowedMessage onMessage(std::span<const std::uint8_t> whole, LocalTime now,
                            std::chrono::system_clock::time_point utc);

  /// Returns whether the message can count of which `begin` is the first piece of several. Most
  /// messages that onMessage() would drop cannot.
  [[nodiscard]] bool mayCount(std::span<const std::uint8_t> begin, LocalTime now,
                              std::chrono::system_clock::time_point utc);

  /// Returns the pong of the followed origin in the whole message `whole` if `is_expected` returns
  /// true for its t0, and if its signature is valid. The number of a pong does not count.
  [[nodiscard]] std::optional<RelayPong> readPong(
      std::span<const std::uint8_t> whole, std::chrono::system_clock::time_point utc,
      const std::function<bool(LocalTime t0)>& is_expected) const;

  /// Returns the term of the followed origin; 0: none.
  [[nodiscard]] std::uint64_t term() const { return leader_ ? leader_->term : 0; }
  /// Returns the last state of the followed origin, a whole message, if an origin of a lower rank
  /// has sent since the last call. Otherwise returns no bytes. The other origin needs it
  /// (RelayPing::proof).
  [[nodiscard]] std::vector<std::uint8_t> popProof();

 private:
  /// The followed origin.
  struct Leader {
    std::uint64_t term;
    std::uint64_t origin;
    VerifyingKey key;
    LocalTime received;                  // time of its last message
    std::vector<std::uint8_t> state;     // its last state, a whole message
    std::optional<std::uint64_t> frame;  // id of its last frame
    std::uint32_t epoch = 0;             // of its last frame
  };
  /// Returns whether the rank of its origin permits that a message counts.
  [[nodiscard]] bool isOfRank(const RelayHead& head, LocalTime now);
  FollowedMessage onOther(const RelayHead& head, std::span<const std::uint8_t> whole,
                          LocalTime now);
  FollowedMessage onLeader(const RelayHead& head, std::span<const std::uint8_t> whole,
                           LocalTime now);

  std::string channel_;
  std::vector<KeyBytes> keys_;
  std::optional<Leader> leader_;
  SeenNumbers seen_;  // of origins that were followed
  RateLimiter checks_ = makeCheckLimiter();
  bool rival_ = false;                                    // an origin of a lower rank has sent
  RateLimiter changes_ = RateLimiter::makeOnceAMinute();  // from an origin that still sends
};

}  // namespace hapticast::server
