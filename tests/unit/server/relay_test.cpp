// SPDX-License-Identifier: MIT
// Pieces of relayed messages, and addresses on NATS.
#include "common/protocol/relay.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "server/relay/nats_address.hpp"
#include "server/relay/origin_follower.hpp"
#include "tests/support/relay_messages.hpp"

namespace hapticast::server {
namespace {

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

/// Returns the pieces of a random number of bytes: a state if `is_state`, else a frame.
std::vector<std::vector<std::uint8_t>> makePieces(SigningKey& key, const RelayHead& head,
                                                  bool is_state, std::mt19937& random) {
  RelayFrame frame = server::makeFrame(head.number);
  frame.delta =
      std::make_shared<const std::vector<std::uint8_t>>(1 + random() % 3000, std::uint8_t{1});
  const RelayContent content =
      is_state ? RelayContent(makeState(key, head.origin)) : RelayContent(frame);
  return splitRelay(makeMessage(key, head, content), head.number,
                    kRelayPieceHeadBytes + 200 + random() % 200);
}

TEST(RelayPieces, SentAgainChangeNothing) {
  constexpr std::chrono::system_clock::time_point kUtc{std::chrono::seconds(1'000'000)};
  OriginFollower follower("lab", {});
  RelayJoiner joiner([&](auto begin) { return follower.mayCount(begin, LocalTime(), kUtc); });
  std::size_t counted = 0;
  const auto add = [&](const std::vector<std::uint8_t>& piece) {
    const auto whole = joiner.add(piece);
    if (whole.ok() && whole.value() &&
        follower.onMessage(*whole.value(), LocalTime(), kUtc).content)
      ++counted;
  };
  std::mt19937 random(7);
  std::vector<std::vector<std::uint8_t>> sent;
  std::size_t messages = 0;
  // The second origin takes over. Its numbers are lower than those of the first one.
  for (RelayHead head : {RelayHead{5, kTestOrigin, 100}, RelayHead{6, kTestOrigin + 1, 0}}) {
    SigningKey key;
    for (std::size_t i = 0; i < 20; ++i) {
      head.number += 1 + random() % 4;
      for (const auto& piece : makePieces(key, head, i == 0, random)) {
        ASSERT_EQ(counted, messages) << "a message counts before its last piece";
        add(piece);
        sent.push_back(piece);
        const std::size_t now = counted;
        for (const auto& again : sent) add(again);
        ASSERT_EQ(counted, now) << "a message counts twice";
      }
      ASSERT_EQ(counted, ++messages) << "a message is lost";
    }
  }
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
