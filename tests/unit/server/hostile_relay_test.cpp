// SPDX-License-Identifier: MIT
// Every kind of relayed message with every extreme of each of its numbers, signed by an unknown
// key, against two origins and two edges. None of them ends a later takeover.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "common/protocol/relay.hpp"
#include "server/relay/election_messages.hpp"
#include "server/relay/origin_election.hpp"
#include "server/relay/origin_follower.hpp"
#include "server/relay/ping_limiter.hpp"
#include "server/relay/seen_numbers.hpp"
#include "tests/support/relay_messages.hpp"

namespace hapticast::server {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kStart_s = 1'790'000'000;  // seconds since 1970

/// An origin without its stream.
struct Origin {
  Origin(std::uint64_t number, std::vector<KeyBytes> trusted)
      : election(number, kStart_s, LocalTime{}), messages("lab", std::move(trusted), election) {}

  void onHeartbeat(std::span<const std::uint8_t> whole, Duration now, bool proof) {
    const auto utc = std::chrono::system_clock::time_point(kStart_s * 1s + now);
    if (proof)
      messages.onProof(whole, LocalTime(now), utc);
    else
      (void)messages.onHeartbeat(whole, LocalTime(now), utc);
  }
  OriginElection election;
  ElectionMessages messages;
};

/// Two origins and two edges. One of each accepts all keys, and one the keys of the origins only.
class HostileRelayTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kFirst = (1ULL << 32U) | 1;  // lower numbers than the rival's
  static constexpr std::uint64_t kSecond = (2ULL << 32U) | 2;

  /// Runs the channel for `time`. The first origin sends heartbeats while it lives.
  void run(Duration time, bool first_lives) {
    for (const Duration end = now_ + time; now_ < end; now_ += 100ms) {
      if (first_lives) beat(*first_, first_key_, kFirst, *second_);
      beat(*second_, second_key_, kSecond, *first_);
    }
  }
  void beat(Origin& origin, SigningKey& key, std::uint64_t number, Origin& other) {
    if (!origin.election.check(LocalTime(now_))) return;
    const auto whole =
        makeMessage(key, {origin.election.term(), number, ++number_}, makeState(key, number));
    other.onHeartbeat(whole, now_, false);
    deliverToEdges(whole);
    const std::uint64_t id = ++number_;
    const auto frame = makeMessage(key, {origin.election.term(), number, id}, makeFrame(id));
    deliverToEdges(frame);
    genuine_.insert(genuine_.end(), {whole, frame});
  }
  /// Delivers every genuine message again, by every way.
  void repeatGenuineMessages() {
    for (const auto& whole : genuine_) {
      for (Origin* const origin : {first_.get(), second_.get()}) {
        origin->onHeartbeat(whole, now_, false);
        origin->onHeartbeat(whole, now_, true);
      }
      deliverToEdges(whole);
    }
  }
  void begin() {
    first_ = std::make_unique<Origin>(kFirst, std::vector<KeyBytes>{});
    second_ = std::make_unique<Origin>(kSecond, keys_);
    open_edge_ = OriginFollower("lab", {});
    strict_edge_ = OriginFollower("lab", keys_);
    genuine_.clear();
    now_ = {};
  }
  void deliverToEdges(std::span<const std::uint8_t> whole) {
    for (OriginFollower* const edge : {&open_edge_, &strict_edge_}) {
      const auto utc = std::chrono::system_clock::time_point(kStart_s * 1s + now_);
      (void)edge->onMessage(whole, LocalTime(now_), utc);
      for (Origin* const origin : {first_.get(), second_.get()})
        origin->onHeartbeat(edge->popProof(), now_, true);
    }
  }
  /// Delivers a hostile message by every way, then lets the first origin end. Returns whether the
  /// second one takes over and both edges follow it.
  bool survives(std::span<const std::uint8_t> whole) {
    run(1200ms, true);
    EXPECT_TRUE(first_->election.active() || second_->election.active());
    deliverToEdges(whole);
    for (Origin* const origin : {first_.get(), second_.get()}) {
      origin->onHeartbeat(whole, now_, false);
      origin->onHeartbeat(whole, now_, true);
    }
    run(1200ms, true);
    run(3500ms, false);
    return secondLeads();
  }
  /// Returns whether the second origin is active and both edges follow it.
  [[nodiscard]] bool secondLeads() const {
    const std::uint64_t term = second_->election.term();
    return second_->election.active() && open_edge_.term() == term && strict_edge_.term() == term;
  }

  SigningKey first_key_, second_key_;
  std::vector<KeyBytes> keys_{first_key_.verifyingKey(), second_key_.verifyingKey()};
  std::unique_ptr<Origin> first_, second_;
  OriginFollower open_edge_{"lab", {}};
  OriginFollower strict_edge_{"lab", keys_};
  Duration now_{};
  std::uint64_t number_ = 0;
  std::vector<std::vector<std::uint8_t>> genuine_;  // of both origins
};

TEST_F(HostileRelayTest, NoMessageEndsALaterTakeover) {
  SigningKey rival;
  for (const std::uint64_t extreme : listExtremes(kStart_s)) {
    for (const auto& whole : listHostileMessages(rival, kStart_s, extreme)) {
      begin();
      EXPECT_TRUE(survives(whole)) << extreme;
    }
  }
}

// A signed message counts once: a recorded stream cannot keep a dead origin alive.
TEST_F(HostileRelayTest, GenuineMessagesAgainDelayNoTakeover) {
  for (int moment = 0; moment < 100; ++moment) {
    begin();
    run(1200ms + moment * 100ms, true);
    ASSERT_TRUE(first_->election.active());
    if (moment % 2 == 0) repeatGenuineMessages();  // also while both live
    ASSERT_TRUE(first_->election.active() && !secondLeads()) << moment;
    const Duration end = now_;
    while (!secondLeads() && now_ < end + 5s) {
      run(100ms, false);
      repeatGenuineMessages();
    }
    EXPECT_LE(now_ - end, 1300ms) << moment;
  }
}

TEST_F(HostileRelayTest, AnOriginThatStartsBesideRepetitionsWaitsOneSecondMore) {
  begin();
  run(2s, true);
  const auto recorded = genuine_;
  second_ = std::make_unique<Origin>(kSecond + 1, keys_);  // both others are gone
  const Duration start = now_;
  second_->election.onDisconnected(LocalTime(now_));
  while (!second_->election.check(LocalTime(now_)) && now_ < start + 20s) {
    now_ += 100ms;
    second_->onHeartbeat(recorded[recorded.size() - 2], now_, false);
  }
  EXPECT_LE(now_ - start, 2200ms);
}

TEST(SeenNumbers, CountsEachNumberOnceAndForgetsTheOldestOrigin) {
  SeenNumbers seen;
  EXPECT_TRUE(seen.isNew(1, 0));
  seen.add(1, 5);
  EXPECT_FALSE(seen.isNew(1, 5) || seen.isNew(1, 4));
  EXPECT_TRUE(seen.isNew(1, 6) && seen.isNew(2, 5));
  seen.add(1, 3);
  EXPECT_FALSE(seen.isNew(1, 5)) << "a lower number lowers nothing";
  for (std::uint64_t origin = 2; origin < 2 + SeenNumbers::kMostOrigins; ++origin)
    seen.add(origin, 1);
  EXPECT_TRUE(seen.isNew(1, 1));
  EXPECT_FALSE(seen.isNew(3, 1));
}

TEST(ElectionMessages, VerifiesAtMostTwoThousandStatesASecond) {
  SigningKey key, other;
  OriginElection election(7, kStart_s, LocalTime{});
  ElectionMessages messages("lab", {}, election);
  const auto utc = std::chrono::system_clock::time_point(kStart_s * 1s);
  int refused = 0;
  for (std::uint64_t i = 1; i <= 5000; ++i) {  // with a wrong signature
    const auto whole = makeMessage(other, {kStart_s + 5, kTestOrigin, i}, makeState(key));
    const std::string problem =
        messages.onHeartbeat(whole, LocalTime(static_cast<std::int64_t>(i) * 200us), utc);
    refused += problem == kTooManyMessages ? 1 : 0;
    EXPECT_FALSE(problem.empty());
  }
  EXPECT_GE(refused, 1900);
  EXPECT_FALSE(election.heardAt());
  EXPECT_EQ(messages.onHeartbeat(makeMessage(key, {kStart_s + 5, kTestOrigin, 1}, makeState(key)),
                                 LocalTime(3s), utc),
            "");
  EXPECT_TRUE(election.heardAt());
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
