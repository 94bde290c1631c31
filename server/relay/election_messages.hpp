// SPDX-License-Identifier: MIT
// Passes the signed states of other origins to the election of one origin: heartbeats, and the
// proofs in pings of edges. Each counts once (SeenNumbers). What rank and number decide comes
// before the signature, and signatures have a limit a second, so floods cost little. Thread: one.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/rate_limiter.hpp"
#include "server/relay/origin_election.hpp"
#include "server/relay/origin_follower.hpp"
#include "server/relay/seen_numbers.hpp"

namespace hapticast::server {

/// The messages that one origin receives about others.
class ElectionMessages {
 public:
  /// `keys`: verifying keys that origins may have; empty: any key. `election` must outlive this
  /// object.
  ElectionMessages(std::string channel, std::vector<KeyBytes> keys, OriginElection& election)
      : channel_(std::move(channel)), keys_(std::move(keys)), election_(election) {}

  /// Processes a whole message of the subject of heartbeats. `now`, `utc`: the time of its arrival,
  /// by two clocks. Returns why it is no heartbeat, for the log; empty: it is one, or it changes
  /// nothing.
  std::string onHeartbeat(std::span<const std::uint8_t> whole, LocalTime now,
                          std::chrono::system_clock::time_point utc);
  /// Processes the state of another origin that an edge has sent (RelayPing::proof).
  void onProof(std::span<const std::uint8_t> whole, LocalTime now,
               std::chrono::system_clock::time_point utc);

 private:
  std::string channel_;
  std::vector<KeyBytes> keys_;
  OriginElection& election_;
  SeenNumbers seen_;
  RateLimiter checks_ = makeCheckLimiter();
};

}  // namespace hapticast::server
