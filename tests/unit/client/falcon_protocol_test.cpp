// SPDX-License-Identifier: MIT
#include "client/device/falcon/protocol.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/support/falcon_bytes.hpp"

namespace hapticast::client {
namespace {

using ::hapticast::testing::decodeRequest;
using ::hapticast::testing::encodeReply;

std::string text(const FalconFrame& frame) { return {frame.begin(), frame.end()}; }

std::vector<FalconReply> parsed(FalconParser& parser, const std::vector<std::uint8_t>& bytes) {
  std::vector<FalconReply> replies;
  for (const std::uint8_t byte : bytes) {
    if (const auto reply = parser.push(byte)) replies.push_back(*reply);
  }
  return replies;
}

std::vector<std::uint8_t> countBytes(const std::vector<FalconReply>& replies) {
  std::vector<std::uint8_t> bytes;
  for (const FalconReply& reply : replies) {
    const FalconFrame frame = encodeReply(reply);
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  return bytes;
}

std::vector<FalconReply> someReplies(std::mt19937& random, int count) {
  std::uniform_int_distribution<int> encoder(-32768, 32767);
  std::uniform_int_distribution<int> bits(0, 15);
  std::vector<FalconReply> replies;
  replies.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    replies.push_back({{encoder(random), encoder(random), encoder(random)},
                       static_cast<std::uint8_t>(bits(random)),
                       static_cast<std::uint8_t>(bits(random) & 7)});
  }
  return replies;
}

TEST(FalconProtocol, FramesHaveTheBytesOfTheDevicesProtocol) {
  EXPECT_EQ(text(encode({.homing = false})), "<AAAAAAAAAAAAAA>");
  EXPECT_EQ(text(encode({.homing = true})), "<AAAAAAAAAAAABA>");
  EXPECT_EQ(text(encode({.motors = {1, -1, 0x123}, .homing = false, .lights = FalconLight::kRed})),
            "<BAAAPPPPDCBAIA>");
  // All flags: homing, green, blue, red.
  EXPECT_EQ(text(encode({.lights = 0x0E})), "<AAAAAAAAAAAAPA>");
}

TEST(FalconProtocol, NoMotorGetsMoreThanTheDriversEverSent) {
  const FalconFrame most = encode({.motors = {100'000, -100'000, 4095}, .homing = false});
  EXPECT_EQ(text(most), "<PPPABAAPPPPAAA>");
  EXPECT_EQ(decodeRequest(most)->motors, (std::array{4095, -4095, 4095}));
}

TEST(FalconProtocol, RepliesAreReadInEveryNumberAndFlag) {
  std::mt19937 random(1);
  const auto sent = someReplies(random, 1000);
  FalconParser parser;
  EXPECT_EQ(parsed(parser, countBytes(sent)), sent);
  EXPECT_EQ(parser.resyncs(), 0U);
  // All buttons and homed bits: the flags reach far beyond the letters of the nibbles.
  const FalconReply full{{0, -1, 32767}, 0x0F, kAllHomed};
  EXPECT_EQ(encodeReply(full)[13], 0xC0);
  EXPECT_EQ(parsed(parser, countBytes({full})), (std::vector{full}));
}

TEST(FalconProtocol, ReadsTheNextWholeFrameAfterATruncatedOrForeignOne) {
  std::mt19937 random(2);
  const auto sent = someReplies(random, 3);
  const auto bytes = countBytes(sent);
  for (std::size_t cut = 1; cut < 16; ++cut) {  // the second frame loses its end
    std::vector<std::uint8_t> damaged = bytes;
    damaged.erase(damaged.begin() + 16 + static_cast<std::ptrdiff_t>(cut), damaged.begin() + 32);
    FalconParser parser;
    EXPECT_EQ(parsed(parser, damaged), (std::vector{sent[0], sent[2]})) << cut;
    EXPECT_EQ(parser.resyncs(), 1U) << cut;
  }
  for (std::size_t lost = 0; lost < 16; ++lost) {  // or one byte of it
    std::vector<std::uint8_t> damaged = bytes;
    damaged.erase(damaged.begin() + 16 + static_cast<std::ptrdiff_t>(lost));
    FalconParser parser;
    const auto read = parsed(parser, damaged);
    ASSERT_EQ(read.size(), 2U) << lost;
    EXPECT_EQ(read.back(), sent[2]);
  }
  std::vector<std::uint8_t> between = bytes;
  const std::string junk = "x<AB<<>>\x01\x60";
  between.insert(between.begin() + 16, junk.begin(), junk.end());
  FalconParser parser;
  EXPECT_EQ(parsed(parser, between), sent);
  EXPECT_EQ(parser.resyncs(), 1U);
}

TEST(FalconProtocol, OutOfNoiseNothingComesButWholeFrames) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> any(0, 255);
  const auto sent = someReplies(random, 300);
  std::vector<std::uint8_t> bytes = countBytes(sent);
  std::uniform_int_distribution<std::size_t> where(0, bytes.size() - 1);
  for (int i = 0; i < 90; ++i) bytes[where(random)] = static_cast<std::uint8_t>(any(random));
  FalconParser parser;
  const auto read = parsed(parser, bytes);
  EXPECT_LT(read.size(), sent.size());
  EXPECT_GE(read.size(), sent.size() - 180);  // a damaged byte costs its frame and the next at most
  EXPECT_GT(parser.resyncs(), 0U);
  std::vector<std::uint8_t> noise(100'000);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(any(random));
  EXPECT_TRUE(parsed(parser, noise).empty()) << "2^-60 and less for each byte";
  EXPECT_EQ(parsed(parser, countBytes(sent)).size(), sent.size());
}

}  // namespace
}  // namespace hapticast::client
