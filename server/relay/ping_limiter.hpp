// SPDX-License-Identifier: MIT
// Limits the pings that an origin answers: a rate limiter for each asker, and one for new askers.
// An asker is the subject for the answer. A flood of pings then costs no signatures and no pongs.
// Known askers keep their places while new ones flood the table. Thread: one.
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>

#include "common/rate_limiter.hpp"
#include "common/time.hpp"

namespace hapticast::server {

/// Limiter of one origin.
class PingLimiter {
 public:
  /// Largest number of askers. Chosen: edges of one channel, with a margin.
  static constexpr std::size_t kMostAskers = 1024;
  /// Time without a ping after which the place of an asker may be used again; chosen.
  static constexpr Duration kForgetAfter = std::chrono::seconds(16);
  /// Pings of one asker: at once, and interval of more. An edge sends 16 pings at 20 ms, then 4 a
  /// second, and one whenever its viewers begin to need pictures or datagrams.
  static constexpr std::int64_t kBurst = 32;
  static constexpr Duration kRefill = std::chrono::milliseconds(100);
  /// New askers: at once, and interval of more; chosen.
  static constexpr std::int64_t kNewBurst = 100;
  static constexpr Duration kNewRefill = std::chrono::milliseconds(10);

  /// Counts a ping that arrived at `now`. Returns whether the origin has to answer it; false if its
  /// sender exceeds its rate, or is one of too many new ones. `asker`: the ping's reply subject,
  /// which identifies the sender.
  [[nodiscard]] bool admit(const std::string& asker, LocalTime now) {
    auto found = askers_.find(asker);
    if (found == askers_.end()) {
      if (!newcomers_.allow(now)) return false;
      if (askers_.size() >= kMostAskers)
        std::erase_if(askers_, [now](const auto& each) {
          return now - each.second.last_ping >= kForgetAfter;
        });
      if (askers_.size() >= kMostAskers) return false;
      found = askers_.try_emplace(asker).first;
    }
    found->second.last_ping = now;
    return found->second.pings.allow(now);
  }
  /// Returns whether `reply` may be the subject for an answer: an inbox of NATS without wildcards.
  /// With any other subject an asker could make the origin publish to edges.
  [[nodiscard]] static bool isInbox(const std::string& reply) {
    constexpr std::size_t kMostReply_bytes = 128;  // libnats makes 29
    return reply.size() <= kMostReply_bytes && reply.starts_with("_INBOX.") &&
           reply.find_first_of("*> \t\r\n") == std::string::npos;
  }

 private:
  struct Asker {
    RateLimiter pings{kBurst, kRefill};
    LocalTime last_ping{};
  };
  std::unordered_map<std::string, Asker> askers_;
  RateLimiter newcomers_{kNewBurst, kNewRefill};
};

}  // namespace hapticast::server
