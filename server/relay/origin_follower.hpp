// SPDX-License-Identifier: MIT
// Decides which origin of a channel an edge follows: the one with the highest (term, origin). It
// verifies the signature of each message with the key of its origin, and drops messages of other
// origins, of earlier terms, and messages out of order. So after a takeover it drops all messages
// of the old origin. It leaves an origin that still sends at most once a minute, so that rivals
// cannot disturb viewers more often. If any key is valid, anybody can send the highest term once,
// so a silent origin then loses its rank. The class has no threads and no clock. Thread: one.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/protocol/relay.hpp"
#include "common/rate_limiter.hpp"
#include "common/transport/signature.hpp"

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
/// Returns the head of the whole message `whole` of `channel` if it is a state that an origin has
/// signed. Returns the errors of readRelayHead() and readTrustedState(). `utc`: the time of its
/// arrival. Thread: any.
[[nodiscard]] Result<RelayHead> readTrustedHead(std::span<const std::uint8_t> whole,
                                                std::string_view channel,
                                                const std::vector<KeyBytes>& keys,
                                                std::chrono::system_clock::time_point utc);

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

  /// Processes a whole message, the result of RelayJoiner. `now`, `utc`: the time of its arrival,
  /// by two clocks.
  FollowedMessage onMessage(std::span<const std::uint8_t> whole, LocalTime now,
                            std::chrono::system_clock::time_point utc);

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
    std::uint64_t number;  // of its last message
    VerifyingKey key;
    LocalTime received;                  // time of its last message
    std::vector<std::uint8_t> state;     // its last state, a whole message
    std::optional<std::uint64_t> frame;  // id of its last frame
    std::uint32_t epoch = 0;             // of its last frame
  };
  FollowedMessage onOther(const RelayHead& head, std::span<const std::uint8_t> whole,
                          LocalTime now);
  FollowedMessage onLeader(const RelayHead& head, std::span<const std::uint8_t> whole,
                           LocalTime now);

  std::string channel_;
  std::vector<KeyBytes> keys_;
  std::optional<Leader> leader_;
  bool rival_ = false;                                    // an origin of a lower rank has sent
  RateLimiter changes_ = RateLimiter::makeOnceAMinute();  // from an origin that still sends
};

}  // namespace hapticast::server
