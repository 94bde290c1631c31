// SPDX-License-Identifier: MIT
// Every kind of relayed message with every extreme of each of its numbers, signed by an unknown
// key, against two origins and two edges. None of them ends a later takeover.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/protocol/relay.hpp"
#include "server/relay/origin_election.hpp"
#include "server/relay/origin_follower.hpp"
#include "server/relay/ping_limiter.hpp"
#include "tests/support/relay_messages.hpp"

namespace hapticast::server {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kStart_s = 1'790'000'000;  // seconds since 1970

/// An origin, as RelayPublisher handles its messages.
struct Origin {
  Origin(std::uint64_t number, std::vector<KeyBytes> trusted)
      : election(number, kStart_s, LocalTime{}), keys(std::move(trusted)) {}

  void onHeartbeat(std::span<const std::uint8_t> whole, Duration now, bool proof) {
    const auto utc = std::chrono::system_clock::time_point(kStart_s * 1s + now);
    const auto head = readTrustedHead(whole, "lab", keys, utc);
    if (!head.ok() || head.value().origin == election.origin()) return;
    if (proof) {
      election.onProvedTerm(head.value().term, LocalTime(now));
    } else {
      election.onHeartbeat(head.value().term, head.value().origin, LocalTime(now));
    }
  }
  OriginElection election;
  std::vector<KeyBytes> keys;
};

/// Two origins and two edges. One of each accepts all keys, and one the keys of the origins only.
class HostileRelayTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kFirst = (1ULL << 32U) | 1;  // lower numbers than the rival's
  static constexpr std::uint64_t kSecond = (2ULL << 32U) | 2;

  /// Runs the channel for `time`. The first origin sends heartbeats while it lives.
  void run(Duration time, bool first_lives) {
    for (const Duration end = now_ + time; now_ < end; now_ += 100ms) {
      if (first_lives) beat(first_, first_key_, kFirst, second_);
      beat(second_, second_key_, kSecond, first_);
    }
  }
  void beat(Origin& origin, SigningKey& key, std::uint64_t number, Origin& other) {
    if (!origin.election.check(LocalTime(now_))) return;
    const auto whole =
        makeMessage(key, {origin.election.term(), number, ++number_}, makeState(key, number));
    other.onHeartbeat(whole, now_, false);
    deliverToEdges(whole);
  }
  void deliverToEdges(std::span<const std::uint8_t> whole) {
    for (OriginFollower* const edge : {&open_edge_, &strict_edge_}) {
      const auto utc = std::chrono::system_clock::time_point(kStart_s * 1s + now_);
      (void)edge->onMessage(whole, LocalTime(now_), utc);
      for (Origin* const origin : {&first_, &second_})
        origin->onHeartbeat(edge->popProof(), now_, true);
    }
  }
  /// Delivers a hostile message by every way, then lets the first origin end. Returns whether the
  /// second one takes over and both edges follow it.
  bool survives(std::span<const std::uint8_t> whole) {
    run(1200ms, true);
    EXPECT_TRUE(first_.election.active() || second_.election.active());
    deliverToEdges(whole);
    for (Origin* const origin : {&first_, &second_}) {
      origin->onHeartbeat(whole, now_, false);
      origin->onHeartbeat(whole, now_, true);
    }
    run(1200ms, true);
    run(3500ms, false);
    const std::uint64_t term = second_.election.term();
    return second_.election.active() && open_edge_.term() == term && strict_edge_.term() == term;
  }

  SigningKey first_key_, second_key_;
  std::vector<KeyBytes> keys_{first_key_.verifyingKey(), second_key_.verifyingKey()};
  Origin first_{kFirst, {}};
  Origin second_{kSecond, keys_};
  OriginFollower open_edge_{"lab", {}};
  OriginFollower strict_edge_{"lab", keys_};
  Duration now_{};
  std::uint64_t number_ = 0;
};

TEST_F(HostileRelayTest, NoMessageEndsALaterTakeover) {
  SigningKey rival;
  for (const std::uint64_t extreme : listExtremes(kStart_s)) {
    for (const auto& whole : listHostileMessages(rival, kStart_s, extreme)) {
      first_ = Origin(kFirst, {});
      second_ = Origin(kSecond, keys_);
      open_edge_ = OriginFollower("lab", {});
      strict_edge_ = OriginFollower("lab", keys_);
      now_ = {};
      EXPECT_TRUE(survives(whole)) << extreme;
    }
  }
}

TEST(PingLimiter, AnswersOnlyInboxes) {
  for (const char* inbox : {"_INBOX.a", "_INBOX.aB3.x", "_INBOX.jhf8Ju2h5mRH0ThhaXf9Vx"})
    EXPECT_TRUE(PingLimiter::isInbox(inbox)) << inbox;
  for (const std::string& other :
       {std::string(), std::string("hapticast.lab.origin.state"), std::string("_INBOX"),
        std::string("_INBOX.>"), std::string("_INBOX.*"), std::string("_INBOX.a b"),
        std::string("x_INBOX.a"), "_INBOX." + std::string(200, 'a')})
    EXPECT_FALSE(PingLimiter::isInbox(other)) << other;
}

TEST(PingLimiter, AnswersEdgesBesideAFlood) {
  PingLimiter limiter;
  const auto ping = [&](int edge, LocalTime now) {
    return limiter.admit("_INBOX.edge" + std::to_string(edge), now);
  };
  int asker = 0;
  std::size_t admitted = 0;
  for (int i = 0; i < 100; ++i) {  // 10 s; the flood begins after 2 s
    const LocalTime now = LocalTime(100s) + i * 100ms;
    for (int edge = 0; edge < 50; ++edge) EXPECT_TRUE(ping(edge, now)) << edge << " at " << i;
    if (i < 20) continue;
    for (int flood = 0; flood < 5000; ++flood) {
      admitted += limiter.admit("_INBOX.other" + std::to_string(asker++), now) ? 1U : 0U;
      admitted += limiter.admit("_INBOX.one", now) ? 1U : 0U;
    }
  }
  EXPECT_LE(admitted, PingLimiter::kMostAskers + 32 + 80);
}

TEST(PingLimiter, ForgetsAskersThatAreSilent) {
  PingLimiter limiter;
  const auto addAll = [&](const std::string& name, LocalTime begin) {
    std::size_t admitted = 0;
    for (std::size_t i = 0; i < PingLimiter::kMostAskers; ++i)
      admitted += limiter.admit(name + std::to_string(i), begin + i * 10ms) ? 1U : 0U;
    return admitted;
  };
  EXPECT_EQ(addAll("_INBOX.a", LocalTime(10s)), PingLimiter::kMostAskers);
  EXPECT_FALSE(limiter.admit("_INBOX.b", LocalTime(21s))) << "the table is full";
  EXPECT_EQ(addAll("_INBOX.c", LocalTime(40s)), PingLimiter::kMostAskers);
}

}  // namespace
}  // namespace hapticast::server
