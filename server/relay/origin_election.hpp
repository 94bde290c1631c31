// SPDX-License-Identifier: MIT
// Leader election among the origins of one channel, by heartbeats and terms (as in Raft, but
// without votes). The active origin sends heartbeats. A standby origin that receives none for a
// second takes over with a higher term. Edges follow the highest (term, origin). So if two origins
// are active, edges ignore one of them. It becomes a standby as soon as it receives a heartbeat of
// the other one. The class has no threads and no clock. Thread: one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/time.hpp"

namespace hapticast::server {

/// State of one origin: standby or active.
class OriginElection {
 public:
  /// Interval of heartbeats.
  static constexpr Duration kHeartbeat = std::chrono::milliseconds(100);
  /// Time without a heartbeat after which a standby becomes active: ten intervals.
  static constexpr Duration kSilence = std::chrono::seconds(1);

  /// Begins as a standby at `now`. `origin`: random number of this origin. `least_term`: lower
  /// bound of the terms of this origin. Use the system's time in seconds. An origin that starts
  /// later then has a higher term, even if all others have ended and it never received a heartbeat.
  OriginElection(std::uint64_t origin, std::uint64_t least_term, LocalTime now)
      : origin_(origin), least_term_(least_term), last_received_(now) {}

  /// Returns whether a heartbeat of another origin with these numbers would change this one.
  [[nodiscard]] bool isRanked(std::uint64_t term, std::uint64_t origin) const {
    return std::pair(term, origin) >= std::pair(highest_, leader_);
  }
  /// Processes the heartbeat of another origin. Requires a term that readRelayHead() accepts.
  void onHeartbeat(std::uint64_t term, std::uint64_t origin, LocalTime now) {
    if (!isRanked(term, origin)) return;
    highest_ = term;
    leader_ = origin;
    last_received_ = now;
    heard_at_ = now;
    active_ = false;
  }
  /// Returns whether a proof of this term would change this origin.
  [[nodiscard]] bool isTermNew(std::uint64_t term) const {
    return term > std::max(highest_, proved_);
  }
  /// Processes the term of another origin that an edge has proved. If this origin is active with a
  /// lower term, such edges ignore it. It continues to send, for edges that do not receive the
  /// other origin yet. A heartbeat of the other origin makes it a standby. After kSilence without a
  /// heartbeat, check() raises its term above the proved one. Requires a term that readRelayHead()
  /// accepts.
  void onProvedTerm(std::uint64_t term, LocalTime now) {
    if (!isTermNew(term)) return;
    proved_ = term;
    proved_since_ = now;
  }
  /// Restarts the measurement of kSilence. Call it while there is no connection, because no
  /// heartbeat can arrive then.
  void onDisconnected(LocalTime now) { last_received_ = now; }
  /// Becomes active after kSilence. Returns whether this origin is active.
  bool check(LocalTime now) {
    const bool outdone = active_ && proved_ > highest_ && now - proved_since_ >= kSilence;
    if (outdone || (!active_ && now - last_received_ >= kSilence)) {
      active_ = true;
      highest_ = std::max({highest_, proved_, least_term_}) + 1;
      leader_ = origin_;
    }
    return active_;
  }

  [[nodiscard]] bool active() const { return active_; }
  /// The term of this origin if it is active, else the highest term that it has seen.
  [[nodiscard]] std::uint64_t term() const { return highest_; }
  [[nodiscard]] std::uint64_t origin() const { return origin_; }
  /// Time of the last heartbeat of another origin; nullopt: none was received.
  [[nodiscard]] std::optional<LocalTime> heardAt() const { return heard_at_; }

 private:
  std::uint64_t origin_;
  std::uint64_t least_term_;
  std::uint64_t highest_ = 0;
  std::uint64_t leader_ = 0;
  std::uint64_t proved_ = 0;  // highest term that edges have proved
  LocalTime proved_since_{};
  LocalTime last_received_;  // begins anew without a connection
  std::optional<LocalTime> heard_at_;
  bool active_ = false;
};

}  // namespace hapticast::server
