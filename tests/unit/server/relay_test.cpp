// SPDX-License-Identifier: MIT
// Election of the active origin, and the choice of an edge, both without a network.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "common/protocol/relay.hpp"
#include "common/transport/datagram.hpp"
#include "server/nats_address.hpp"
#include "server/relay/origin_election.hpp"
#include "server/relay/origin_follower.hpp"

namespace hapticast::server {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kTerm = 1000;

LocalTime at(Duration time) { return LocalTime(10s) + time; }

TEST(OriginElection, TakesOverAfterASecondOfSilenceWithAHigherTerm) {
  OriginElection election(7, kTerm, at(0s));
  EXPECT_FALSE(election.check(at(999ms)));
  EXPECT_TRUE(election.check(at(1s)));
  EXPECT_EQ(election.term(), kTerm + 1);
}

TEST(OriginElection, StaysStandbyWhileAnotherSends) {
  OriginElection election(7, kTerm, at(0s));
  for (auto time = 0ms; time < 5s; time += 100ms) {
    election.onHeartbeat(kTerm + 5, 9, at(time));
    EXPECT_FALSE(election.check(at(time + 99ms)));
  }
  election.onDisconnected(at(4950ms));
  EXPECT_EQ(election.heardAt(), at(4900ms));
  EXPECT_TRUE(election.check(at(6s)));
  EXPECT_EQ(election.term(), kTerm + 6);
}

TEST(OriginElection, StaysStandbyForAnOriginThatStartedEarlier) {
  OriginElection election(7, kTerm, at(0s));
  for (auto time = 0ms; time < 5s; time += 100ms) {
    election.onHeartbeat(kTerm - 60, 9, at(time));
    EXPECT_FALSE(election.check(at(time + 99ms)));
  }
  EXPECT_TRUE(election.check(at(6s)));
  EXPECT_EQ(election.term(), kTerm + 1) << "above its own start, too";
}

TEST(OriginElection, StepsBackForAHigherTermAndForAHigherOriginOfTheSameTerm) {
  OriginElection election(7, kTerm, at(0s));
  ASSERT_TRUE(election.check(at(1s)));
  election.onHeartbeat(kTerm, 99, at(1100ms));
  EXPECT_TRUE(election.active()) << "a lower term";
  election.onHeartbeat(kTerm + 1, 6, at(1200ms));
  EXPECT_TRUE(election.active()) << "the same term, a lower origin";
  election.onHeartbeat(kTerm + 1, 8, at(1300ms));
  EXPECT_FALSE(election.active());
}

TEST(OriginElection, SendsUntilItReceivesTheOriginWhoseTermEdgesHaveSeen) {
  OriginElection election(7, kTerm, at(0s));
  ASSERT_TRUE(election.check(at(1s)));
  election.onSeenTerm(kTerm + 50, at(2s));
  EXPECT_TRUE(election.check(at(2900ms)));
  EXPECT_EQ(election.term(), kTerm + 1);
  election.onHeartbeat(kTerm + 50, 9, at(2950ms));
  EXPECT_FALSE(election.check(at(3s)));
}

TEST(OriginElection, TakesOverFromAnOriginThatOnlyEdgesHaveSeen) {
  OriginElection election(7, kTerm, at(0s));
  ASSERT_TRUE(election.check(at(1s)));
  election.onSeenTerm(kTerm + 1, at(1s));
  EXPECT_TRUE(election.check(at(5s)));
  EXPECT_EQ(election.term(), kTerm + 1) << "its own term";
  election.onSeenTerm(kTerm + 50, at(6s));
  election.onSeenTerm(kTerm + 50, at(6900ms));
  EXPECT_TRUE(election.check(at(7s)));
  EXPECT_EQ(election.term(), kTerm + 51);
}

TEST(OriginElection, DoesNotCountTheTimeWithoutAConnection) {
  OriginElection election(7, kTerm, at(0s));
  for (auto time = 0ms; time <= 5s; time += 100ms) {
    election.onDisconnected(at(time));
    EXPECT_FALSE(election.check(at(time)));
  }
  EXPECT_FALSE(election.check(at(5900ms)));
  EXPECT_TRUE(election.check(at(6s)));
}

TEST(OriginElection, IgnoresATermThatLeavesNoRoom) {
  OriginElection election(7, kTerm, at(0s));
  election.onHeartbeat(~std::uint64_t{0}, 9, at(500ms));
  election.onSeenTerm(OriginElection::kHighestTerm + 1, at(500ms));
  EXPECT_TRUE(election.check(at(1s)));
  EXPECT_EQ(election.term(), kTerm + 1);
}

// However heartbeats of several origins are delayed and lost, at most one origin remains active
// once they arrive again.
TEST(OriginElection, OneOriginRemainsAfterEveryPartition) {
  std::mt19937 random(33);
  for (int round = 0; round < 200; ++round) {
    std::vector<OriginElection> origins;
    for (std::uint64_t i = 0; i < 3; ++i)
      origins.emplace_back(random() % 1000 + 1000 * i, kTerm, at(0s));
    const Duration healed = std::chrono::milliseconds(random() % 8000);
    for (Duration time{}; time < healed + 3s; time += 100ms) {
      for (std::size_t from = 0; from < origins.size(); ++from) {
        if (!origins[from].check(at(time))) continue;
        for (std::size_t to = 0; to < origins.size(); ++to) {
          const bool lost = time < healed && random() % 3 != 0;
          if (to != from && !lost)
            origins[to].onHeartbeat(origins[from].term(), origins[from].origin(), at(time));
        }
      }
    }
    const auto active = std::count_if(origins.begin(), origins.end(),
                                      [](const OriginElection& each) { return each.active(); });
    EXPECT_EQ(active, 1) << "round " << round;
  }
}

class OriginFollowerTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kOrigin = (std::uint64_t{5} << 32U) | 77;

  static RelayState state(const SigningKey& key, std::uint64_t origin = kOrigin) {
    RelayState state;
    state.description.name = "clip";
    state.stream = static_cast<std::uint32_t>(origin);
    state.verifying_key = key.verifyingKey();
    state.probe.resize(kMostDatagramBytes - kTokenBytes);
    return state;
  }
  static RelayFrame frame(std::uint64_t id, std::uint32_t epoch = 1) {
    RelayFrame frame;
    frame.epoch = epoch;
    frame.id = id;
    frame.delta = std::make_shared<const std::vector<std::uint8_t>>(100, std::uint8_t{1});
    return frame;
  }
  static std::vector<std::uint8_t> message(SigningKey& key, RelayHead head,
                                           const RelayContent& content,
                                           const std::string& channel = "lab") {
    return encodeRelay(channel, head, content, [&key](auto bytes) { return key.sign(bytes); });
  }

  SigningKey key_;
  OriginFollower follower_{"lab", {}};
};

TEST_F(OriginFollowerTest, FollowsAnOriginFromItsFirstState) {
  EXPECT_FALSE(follower_.onMessage(message(key_, {5, kOrigin, 1}, frame(1))).content)
      << "a frame before the first state";
  const auto first = follower_.onMessage(message(key_, {5, kOrigin, 2}, state(key_)));
  EXPECT_TRUE(first.content && first.new_origin);
  const auto next = follower_.onMessage(message(key_, {5, kOrigin, 3}, frame(2)));
  EXPECT_TRUE(next.content && !next.new_origin);
  EXPECT_EQ(follower_.term(), 5U);
}

TEST_F(OriginFollowerTest, DropsTheOldOriginAfterATakeover) {
  SigningKey other;
  const std::uint64_t origin = (std::uint64_t{1} << 32U) | 78;
  ASSERT_TRUE(follower_.onMessage(message(key_, {5, kOrigin, 1}, state(key_))).content);
  ASSERT_TRUE(follower_.onMessage(message(other, {6, origin, 1}, state(other, origin))).new_origin);
  for (const RelayContent& content : {RelayContent(frame(9)), RelayContent(state(key_))}) {
    const auto old = follower_.onMessage(message(key_, {5, kOrigin, 9}, content));
    EXPECT_FALSE(old.content);
    EXPECT_EQ(old.problem, "") << "usual after a takeover";
  }
  EXPECT_TRUE(follower_.onMessage(message(other, {6, origin, 2}, frame(1))).content)
      << "frame ids of a new origin begin anew";
}

TEST_F(OriginFollowerTest, ReportsWhyItDropsAMessage) {
  SigningKey other;
  ASSERT_TRUE(follower_.onMessage(message(key_, {5, kOrigin, 1}, state(key_))).content);
  ASSERT_TRUE(follower_.onMessage(message(key_, {5, kOrigin, 2}, frame(10, 3))).content);
  const auto problem = [&](const std::vector<std::uint8_t>& whole) {
    const auto dropped = follower_.onMessage(whole);
    EXPECT_FALSE(dropped.content);
    return dropped.problem;
  };
  EXPECT_EQ(problem({1, 2, 3}), "bytes that are not a relayed message");
  EXPECT_EQ(problem(message(key_, {5, kOrigin, 3}, frame(11), "studio")),
            "a message of another channel");
  EXPECT_EQ(problem(message(other, {5, kOrigin, 3}, frame(11))),
            "a message has no valid signature of its origin");
  EXPECT_EQ(problem(message(key_, {5, kOrigin, 2}, frame(11, 3))),
            "a message arrives twice or too late");
  EXPECT_EQ(problem(message(key_, {5, kOrigin, 3}, frame(10, 3))),
            "a frame is older than the one before");
  EXPECT_EQ(problem(message(key_, {5, kOrigin, 4}, frame(11, 2))),
            "a frame is older than the one before");
  EXPECT_EQ(problem(message(other, {~std::uint64_t{0}, kOrigin, 1}, state(other))),
            "a term is too high");
  EXPECT_EQ(problem(message(other, {6, kOrigin + 1, 1}, state(other))),
            "a state contradicts the number of its origin");
  EXPECT_EQ(problem(message(key_, {6, kOrigin, 1}, state(other))),
            "a state has no valid signature");
  EXPECT_TRUE(follower_.onMessage(message(key_, {5, kOrigin, 5}, frame(11, 3))).content)
      << "no wrong message has changed the follower";
}

TEST_F(OriginFollowerTest, FollowsOnlyAnExpectedKey) {
  SigningKey other;
  OriginFollower follower("lab", {key_.verifyingKey()});
  EXPECT_EQ(follower.onMessage(message(other, {6, kOrigin, 1}, state(other))).problem,
            "an origin has another key than --origin-key");
  EXPECT_TRUE(follower.onMessage(message(key_, {5, kOrigin, 1}, state(key_))).new_origin);
}

TEST_F(OriginFollowerTest, AStateHasTheKeyOfSealedDatagramsOrMarksItsAbsence) {
  RelayState sealed = state(key_);
  sealed.sealed = true;
  std::uint64_t number = 0;
  const auto pass = [&](const RelayState& each) {
    const auto followed = follower_.onMessage(message(key_, {5, kOrigin, ++number}, each));
    return followed.content ? std::optional(std::get<RelayState>(*followed.content)) : std::nullopt;
  };
  const auto without = pass(sealed);
  ASSERT_TRUE(without);
  EXPECT_TRUE(without->sealed);
  EXPECT_FALSE(without->datagram_key);
  sealed.datagram_key = DatagramKey{7, SealKeyBytes{1, 2, 3}, 10s};
  const auto with = pass(sealed);
  ASSERT_TRUE(with);
  EXPECT_EQ(with->datagram_key, sealed.datagram_key);
  sealed.sealed = false;
  EXPECT_FALSE(pass(sealed)) << "a key of a stream that is not sealed";
}

TEST_F(OriginFollowerTest, NoByteOfAMessageCanChange) {
  ASSERT_TRUE(follower_.onMessage(message(key_, {5, kOrigin, 1}, state(key_))).content);
  const auto whole = message(key_, {5, kOrigin, 2}, frame(1));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    auto changed = whole;
    changed[i] ^= 1U;
    EXPECT_FALSE(follower_.onMessage(changed).content) << "byte " << i;
  }
  EXPECT_TRUE(follower_.onMessage(whole).content);
}

TEST(RelayPieces, JoinToTheSameMessageAtAnySize) {
  std::mt19937 random(34);
  for (const std::size_t size : {1U, 100U, 999U, 1000U, 1001U, 70'000U}) {
    std::vector<std::uint8_t> whole(size);
    for (auto& byte : whole) byte = static_cast<std::uint8_t>(random());
    for (const std::size_t most :
         {kRelayPieceHeadBytes + 100, kRelayPieceHeadBytes + 1000, std::size_t{1} << 20U}) {
      RelayJoiner joiner;
      const auto pieces = splitRelay(whole, 5, most);
      ASSERT_FALSE(pieces.empty());
      for (std::size_t i = 0; i < pieces.size(); ++i) {
        EXPECT_LE(pieces[i].size(), most);
        const auto joined = joiner.add(pieces[i]);
        ASSERT_TRUE(joined.ok());
        EXPECT_EQ(joined.value().has_value(), i + 1 == pieces.size());
        if (!joined.value()) continue;
        EXPECT_EQ(*joined.value(), whole);
      }
    }
  }
}

TEST(RelayPieces, AMissingPieceLosesItsMessageOnly) {
  const std::vector<std::uint8_t> whole(1000, std::uint8_t{3});
  const auto first = splitRelay(whole, 1, 316), second = splitRelay(whole, 2, 316);
  ASSERT_EQ(first.size(), 4U);
  RelayJoiner joiner;
  EXPECT_TRUE(joiner.add(first[0]).ok());
  EXPECT_FALSE(joiner.add(first[2]).ok()) << "piece 1 is missing";
  EXPECT_FALSE(joiner.add(first[3]).ok());
  for (std::size_t i = 0; i + 1 < second.size(); ++i) EXPECT_TRUE(joiner.add(second[i]).ok());
  const auto joined = joiner.add(second.back());
  ASSERT_TRUE(joined.ok() && joined.value());
  EXPECT_EQ(*joined.value(), whole);
}

TEST(RelayPieces, StoreNoMoreThanTheLargestMessage) {
  const std::vector<std::uint8_t> large(kMostRelayBytes / 4 + 1);
  auto pieces = splitRelay(std::vector<std::uint8_t>(5), 1, kRelayPieceHeadBytes + 1);
  ASSERT_EQ(pieces.size(), 5U);
  RelayJoiner joiner;
  for (std::size_t i = 0; i < 4; ++i) {
    pieces[i].insert(pieces[i].end(), large.begin(), large.end());
    const auto added = joiner.add(pieces[i]);
    EXPECT_EQ(added.ok(), i < 3);
    if (added.ok()) continue;
    EXPECT_EQ(added.error().code, ErrorCode::kTooLarge);
  }
}

TEST(NatsAddress, IsParsedOrRefused) {
  const auto one = parseNatsAddress("nats://host/lab");
  ASSERT_TRUE(one);
  EXPECT_EQ(*one, (NatsAddress{{{"host", 4222}}, "lab", "", {}}));
  const auto two = parseNatsAddress("nats://10.0.0.1:5000,[::1]:6000/a_B-3");
  ASSERT_TRUE(two);
  EXPECT_EQ(toString(*two), "nats://10.0.0.1:5000,[::1]:6000/a_B-3");
  for (const char* wrong :
       {"nats://host", "nats://host/", "nats:///lab", "nats://host/a.b", "nats://host/>",
        "nats://a,/lab", "nats://host:0/lab", "http://host/lab", "nats://host/lab/more",
        "nats://host:99999/lab", "lab"})
    EXPECT_FALSE(parseNatsAddress(wrong)) << wrong;
  EXPECT_FALSE(parseNatsAddress("nats://host/" + std::string(65, 'a')));
}

TEST(NatsAddress, MayHaveAUserWhomNoMessageShows) {
  const auto user = parseNatsAddress("nats://me:p%40ss%2F@host,other:5000/lab");
  ASSERT_TRUE(user);
  EXPECT_EQ(user->user, "me");
  EXPECT_EQ(user->password, "p@ss/");
  EXPECT_EQ(user->servers.size(), 2U);
  EXPECT_EQ(toString(*user), "nats://host:4222,other:5000/lab");
  const auto token = parseNatsAddress("nats://s3cr3t@host/lab");
  ASSERT_TRUE(token);
  EXPECT_EQ(token->user, "s3cr3t");
  EXPECT_FALSE(token->password);
  for (const char* wrong : {"nats://@host/lab", "nats://:word@host/lab", "nats://me:p%4@host/lab",
                            "nats://me:p%zz@host/lab", "nats://me:p@ss@host/lab"})
    EXPECT_FALSE(parseNatsAddress(wrong)) << wrong;
}

}  // namespace
}  // namespace hapticast::server
