// SPDX-License-Identifier: MIT
// Choice of an edge among the origins of a channel, without a network.
#include "server/relay/origin_follower.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/protocol/relay.hpp"
#include "tests/support/relay_messages.hpp"

namespace hapticast::server {
namespace {

using namespace std::chrono_literals;

LocalTime arriveAt(Duration time) { return LocalTime(10s) + time; }

class OriginFollowerTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kOrigin = kTestOrigin;

  /// Passes a message to the follower.
  FollowedMessage follow(const std::vector<std::uint8_t>& whole, LocalTime now = arriveAt(0s)) {
    return follower_.onMessage(whole, now, kUtc);
  }

  static constexpr std::chrono::system_clock::time_point kUtc{1'000'000s};
  SigningKey key_;
  OriginFollower follower_{"lab", {}};
};

TEST_F(OriginFollowerTest, FollowsAnOriginFromItsFirstState) {
  EXPECT_FALSE(follow(makeMessage(key_, {5, kOrigin, 1}, makeFrame(1))).content)
      << "a frame before the first state";
  const auto first = follow(makeMessage(key_, {5, kOrigin, 2}, makeState(key_)));
  EXPECT_TRUE(first.content && first.new_origin);
  const auto next = follow(makeMessage(key_, {5, kOrigin, 3}, makeFrame(2)));
  EXPECT_TRUE(next.content && !next.new_origin);
  EXPECT_EQ(follower_.term(), 5U);
}

TEST_F(OriginFollowerTest, DropsTheOldOriginAfterATakeover) {
  SigningKey other;
  const std::uint64_t origin = (std::uint64_t{1} << 32U) | 78;
  ASSERT_TRUE(follow(makeMessage(key_, {5, kOrigin, 1}, makeState(key_))).content);
  ASSERT_TRUE(follow(makeMessage(other, {6, origin, 1}, makeState(other, origin))).new_origin);
  for (const RelayContent& content : {RelayContent(makeFrame(9)), RelayContent(makeState(key_))}) {
    const auto old = follow(makeMessage(key_, {5, kOrigin, 9}, content));
    EXPECT_FALSE(old.content);
    EXPECT_EQ(old.problem, "") << "usual after a takeover";
  }
  EXPECT_TRUE(follow(makeMessage(other, {6, origin, 2}, makeFrame(1))).content)
      << "frame ids of a new origin begin anew";
}

TEST_F(OriginFollowerTest, ReportsWhyItDropsAMessage) {
  SigningKey other;
  ASSERT_TRUE(follow(makeMessage(key_, {5, kOrigin, 1}, makeState(key_))).content);
  ASSERT_TRUE(follow(makeMessage(key_, {5, kOrigin, 2}, makeFrame(10, 3))).content);
  const auto problem = [&](const std::vector<std::uint8_t>& whole) {
    const auto dropped = follow(whole);
    EXPECT_FALSE(dropped.content);
    return dropped.problem;
  };
  EXPECT_EQ(problem({1, 2, 3}), "bytes that are not a relayed message");
  EXPECT_EQ(problem(makeMessage(key_, {5, kOrigin, 3}, makeFrame(11), "studio")),
            "a message of another channel");
  EXPECT_EQ(problem(makeMessage(other, {5, kOrigin, 3}, makeFrame(11))),
            "a message has no valid signature of its origin");
  EXPECT_EQ(problem(makeMessage(key_, {5, kOrigin, 2}, makeFrame(11, 3))),
            "a message arrives twice or too late");
  EXPECT_EQ(problem(makeMessage(key_, {5, kOrigin, 3}, makeFrame(10, 3))),
            "a frame is older than the one before");
  EXPECT_EQ(problem(makeMessage(key_, {5, kOrigin, 4}, makeFrame(11, 2))),
            "a frame is older than the one before");
  EXPECT_EQ(problem(makeMessage(other, {~std::uint64_t{0}, kOrigin, 1}, makeState(other))),
            "a term is more than a day ahead of this machine's clock; set both clocks");
  EXPECT_EQ(problem(makeMessage(other, {6, kOrigin + 1, 1}, makeState(other))),
            "a state contradicts the number of its origin");
  EXPECT_EQ(problem(makeMessage(key_, {6, kOrigin + 1, 1}, makeState(other, kOrigin + 1))),
            "a state has no valid signature");
  EXPECT_EQ(problem(makeMessage(other, {6, kOrigin, 9}, makeState(other))),
            "a message has no valid signature of its origin")
      << "another origin with the number of the followed one";
  EXPECT_TRUE(follow(makeMessage(key_, {5, kOrigin, 5}, makeFrame(11, 3))).content)
      << "no wrong message has changed the follower";
}

TEST_F(OriginFollowerTest, AcceptsATermUpToADayAhead) {
  constexpr std::uint64_t kLatest = 1'000'000 + 86'400;
  EXPECT_TRUE(follow(makeMessage(key_, {kLatest, kOrigin, 1}, makeState(key_))).new_origin);
  EXPECT_FALSE(follow(makeMessage(key_, {kLatest + 1, kOrigin, 2}, makeState(key_))).content);
  EXPECT_EQ(follower_.term(), kLatest);
}

TEST_F(OriginFollowerTest, AnOriginThatRaisesItsTermIsNoNewOne) {
  ASSERT_TRUE(follow(makeMessage(key_, {5, kOrigin, 1}, makeState(key_))).new_origin);
  ASSERT_TRUE(follow(makeMessage(key_, {5, kOrigin, 2}, makeFrame(7))).content);
  const auto raised = follow(makeMessage(key_, {9, kOrigin, 3}, makeState(key_)));
  EXPECT_TRUE(raised.content && !raised.new_origin);
  EXPECT_EQ(follower_.term(), 9U);
  EXPECT_FALSE(follow(makeMessage(key_, {9, kOrigin, 4}, makeFrame(7))).content)
      << "its frames go on";
  EXPECT_TRUE(follow(makeMessage(key_, {9, kOrigin, 5}, makeFrame(8))).content);
  EXPECT_FALSE(follow(makeMessage(key_, {5, kOrigin, 6}, makeFrame(9))).content)
      << "the term before";
}

TEST_F(OriginFollowerTest, LeavesAnOriginThatStillSendsAtMostOnceAMinute) {
  SigningKey rival;
  std::uint64_t number = 0, term = 5, changes = 0;
  ASSERT_TRUE(follow(makeMessage(key_, {term, kOrigin, ++number}, makeState(key_))).new_origin);
  for (Duration time{}; time < 59s; time += 100ms) {
    // The true origin raises its term each time that the rival goes beyond it.
    changes +=
        follow(makeMessage(rival, {++term, kOrigin + 1, ++number}, makeState(rival, kOrigin + 1)),
               arriveAt(time))
                .new_origin
            ? 1
            : 0;
    changes +=
        follow(makeMessage(key_, {++term, kOrigin, ++number}, makeState(key_)), arriveAt(time))
                .new_origin
            ? 1
            : 0;
  }
  EXPECT_LE(changes, 2U);
}

TEST_F(OriginFollowerTest, LeavesASilentOriginAtOnce) {
  SigningKey other;
  std::uint64_t term = 5;
  ASSERT_TRUE(follow(makeMessage(key_, {term, kOrigin, 1}, makeState(key_))).new_origin);
  for (Duration time = 1s; time < 60s; time += 1s) {
    const std::uint64_t origin = kOrigin + 1 + term % 2;
    ++term;
    EXPECT_TRUE(
        follow(makeMessage(other, {term, origin, term}, makeState(other, origin)), arriveAt(time))
            .new_origin);
  }
}

TEST_F(OriginFollowerTest, ASilentOriginLosesItsRankWhereAnyKeyIsValid) {
  SigningKey rival;
  OriginFollower strict("lab", {key_.verifyingKey(), rival.verifyingKey()});
  const auto high = makeMessage(rival, {900, kOrigin + 1, 1}, makeState(rival, kOrigin + 1));
  const auto low = makeMessage(key_, {5, kOrigin, 1}, makeState(key_));
  ASSERT_TRUE(follow(high).new_origin);
  ASSERT_TRUE(strict.onMessage(high, arriveAt(0s), kUtc).new_origin);
  EXPECT_FALSE(follow(low, arriveAt(OriginFollower::kLoseRankAfter - 1ms)).content);
  EXPECT_TRUE(follow(low, arriveAt(OriginFollower::kLoseRankAfter)).new_origin);
  EXPECT_FALSE(strict.onMessage(low, arriveAt(OriginFollower::kLoseRankAfter), kUtc).content)
      << "somebody could send an old stream again";
}

TEST_F(OriginFollowerTest, ProvesItsTermToAnOriginOfALowerRank) {
  SigningKey other;
  const auto first = makeMessage(key_, {5, kOrigin, 1}, makeState(key_));
  const auto second = makeMessage(key_, {5, kOrigin, 2}, makeState(key_));
  ASSERT_TRUE(follow(first).content && follow(second).content);
  EXPECT_TRUE(follower_.popProof().empty()) << "no other origin sends";
  (void)follow(makeMessage(other, {4, kOrigin + 1, 1}, makeState(other, kOrigin + 1)));
  EXPECT_EQ(follower_.popProof(), second);
  EXPECT_TRUE(follower_.popProof().empty()) << "once";
}

TEST_F(OriginFollowerTest, FollowsOnlyAnExpectedKey) {
  SigningKey other;
  OriginFollower follower("lab", {key_.verifyingKey()});
  EXPECT_EQ(
      follower.onMessage(makeMessage(other, {6, kOrigin, 1}, makeState(other)), arriveAt(0s), kUtc)
          .problem,
      "an origin has another key than --origin-key");
  EXPECT_TRUE(
      follower.onMessage(makeMessage(key_, {5, kOrigin, 1}, makeState(key_)), arriveAt(0s), kUtc)
          .new_origin);
}

TEST_F(OriginFollowerTest, AStateHasTheKeyOfSealedDatagramsOrMarksItsAbsence) {
  RelayState sealed = makeState(key_);
  sealed.sealed = true;
  std::uint64_t number = 0;
  const auto pass = [&](const RelayState& each) {
    const auto followed = follow(makeMessage(key_, {5, kOrigin, ++number}, each));
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

TEST_F(OriginFollowerTest, ARepetitionKeepsNoSilentOrigin) {
  SigningKey rival;
  const auto high = makeMessage(rival, {900, kOrigin + 1, 1}, makeState(rival, kOrigin + 1));
  ASSERT_TRUE(follow(high).new_origin);
  for (Duration time = 100ms; time < 4s; time += 100ms)
    EXPECT_FALSE(follow(high, arriveAt(time)).content);
  EXPECT_TRUE(follow(makeMessage(key_, {5, kOrigin, 1}, makeState(key_)), arriveAt(4s)).new_origin);
  EXPECT_FALSE(follow(high, arriveAt(10s)).content) << "it was followed before";
}

TEST_F(OriginFollowerTest, APongCountsForAnExpectedPingOfTheFollowedOriginOnly) {
  SigningKey other;
  ASSERT_TRUE(follow(makeMessage(key_, {5, kOrigin, 1}, makeState(key_))).content);
  const RelayPong pong{LocalTime(1s), MediaTime(2s), MediaTime(3s)};
  int asked = 0;
  const auto read = [&](SigningKey& key, std::uint64_t origin, LocalTime expected) {
    return follower_.readPong(makeMessage(key, {5, origin, 0}, pong), kUtc, [&](LocalTime t0) {
      ++asked;
      return t0 == expected;
    });
  };
  EXPECT_TRUE(read(key_, kOrigin, LocalTime(1s)));
  EXPECT_FALSE(read(key_, kOrigin, LocalTime(2s)));
  EXPECT_FALSE(read(other, kOrigin, LocalTime(1s)));
  EXPECT_EQ(asked, 3);
  EXPECT_FALSE(read(key_, kOrigin + 1, LocalTime(1s)));
  EXPECT_EQ(asked, 3) << "of another origin";
  EXPECT_FALSE(follow(makeMessage(key_, {5, kOrigin, 2}, pong)).content) << "not by this way";
}

TEST_F(OriginFollowerTest, NoByteOfAMessageCanChange) {
  ASSERT_TRUE(follow(makeMessage(key_, {5, kOrigin, 1}, makeState(key_))).content);
  const auto whole = makeMessage(key_, {5, kOrigin, 2}, makeFrame(1));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    auto changed = whole;
    changed[i] ^= 1U;
    EXPECT_FALSE(follow(changed).content) << "byte " << i;
  }
  EXPECT_TRUE(follow(whole).content);
}

}  // namespace
}  // namespace hapticast::server
