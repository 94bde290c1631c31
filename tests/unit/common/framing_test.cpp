// SPDX-License-Identifier: MIT
#include "common/transport/framing.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/framed.hpp"

namespace hapticast {
namespace {

using testing::framed;
using Bytes = std::vector<std::uint8_t>;

Bytes message(std::size_t size, std::uint8_t fill) { return Bytes(size, fill); }

TEST(Framing, PutsALittleEndianLengthInFront) {
  EXPECT_EQ(framed(Bytes{0xAA, 0xBB}), (Bytes{2, 0, 0, 0, 0xAA, 0xBB}));
  EXPECT_EQ(lengthPrefix(0x012345), (LengthPrefix{0x45, 0x23, 0x01, 0x00}));
  EXPECT_EQ(lengthPrefix(kMaxMessageBytes), (LengthPrefix{0x00, 0x00, 0x80, 0x00}));
}

TEST(Framing, GivesTheSameMessagesHoweverTheStreamIsCut) {
  std::mt19937 random(3);
  Bytes stream;
  std::vector<Bytes> sent;
  for (std::size_t i = 0; i < 50; ++i) {
    sent.push_back(message(1 + random() % 300, static_cast<std::uint8_t>(i)));
    const auto bytes = framed(sent.back());
    stream.insert(stream.end(), bytes.begin(), bytes.end());
  }
  for (int round = 0; round < 100; ++round) {
    LengthFraming reader(1024);
    std::vector<Bytes> got;
    for (std::size_t at = 0; at < stream.size();) {
      const std::size_t size =
          std::min<std::size_t>(round == 0 ? 1 : random() % 700, stream.size() - at);
      reader.feed(std::span(stream).subspan(at, size));
      at += size;
      for (auto next = reader.next(); next.ok() && next.value(); next = reader.next()) {
        got.emplace_back(next.value()->begin(), next.value()->end());
      }
    }
    ASSERT_EQ(got, sent);
  }
}

TEST(Framing, RefusesTooLongAsSoonAsTheLengthIsThere) {
  LengthFraming reader(100);
  reader.feed(framed(message(100, 1)));
  ASSERT_TRUE(reader.next().ok());
  reader.feed(Bytes{101, 0, 0, 0});
  const auto next = reader.next();
  ASSERT_FALSE(next.ok());
  EXPECT_EQ(next.error().code, ErrorCode::kTooLarge);
  EXPECT_NE(next.error().message.find("101"), std::string::npos);
  reader.feed(framed(message(5, 1)));
  EXPECT_FALSE(reader.next().ok()) << "a stream that lost its frame stays refused";
}

TEST(Framing, RefusesLengthZeroAndTheLargestLength) {
  LengthFraming zero(100);
  zero.feed(Bytes{0, 0, 0, 0});
  EXPECT_EQ(zero.next().error().code, ErrorCode::kMalformed);
  LengthFraming huge(kMaxMessageBytes);
  huge.feed(Bytes{0xFF, 0xFF, 0xFF, 0xFF});
  EXPECT_EQ(huge.next().error().code, ErrorCode::kTooLarge);
}

TEST(Framing, LimitCanBeRaised) {
  LengthFraming reader(10);
  const auto bytes = framed(message(50, 9));
  reader.setLimit(50);
  reader.feed(bytes);
  const auto next = reader.next();
  ASSERT_TRUE(next.ok() && next.value());
  EXPECT_EQ(next.value()->size(), 50U);
  EXPECT_FALSE(reader.next().value()) << "nothing left";
}

TEST(Framing, CarriesTheLargestMessage) {
  LengthFraming reader(kMaxMessageBytes);
  const auto bytes = framed(message(kMaxMessageBytes, 5));
  for (std::size_t at = 0; at < bytes.size(); at += 65536) {
    ASSERT_FALSE(reader.next().value());
    reader.feed(std::span(bytes).subspan(at, std::min<std::size_t>(65536, bytes.size() - at)));
  }
  const auto next = reader.next();
  ASSERT_TRUE(next.ok() && next.value());
  EXPECT_EQ(next.value()->size(), kMaxMessageBytes);
}

}  // namespace
}  // namespace hapticast
