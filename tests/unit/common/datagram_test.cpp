// SPDX-License-Identifier: MIT
#include "common/transport/datagram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/datagram_bytes.hpp"

namespace hapticast {
namespace {

using DatagramBytes = std::vector<std::uint8_t>;

DatagramHeader someHeader() { return {0x01020304, 7, 0x1122334455667788, mediaTime(1.5), 3, 9}; }

TEST(DatagramTest, ReadsAWrittenDatagram) {
  SigningKey key;
  const auto verifying = VerifyingKey::from(key.verifyingKey());
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kMostPieceBytes}) {
    const DatagramBytes payload(size, 0xAB);
    const DatagramBytes bytes =
        testing::datagramBytes(0x8877665544332211, signedBody(someHeader(), payload, key));
    EXPECT_EQ(bytes.size(), 101 + size);
    EXPECT_LE(bytes.size() + kSealBytes, kMostDatagramBytes) << "there is room for a seal";
    const auto datagram = readDatagram(bytes);
    ASSERT_TRUE(datagram);
    EXPECT_EQ(datagram->token, 0x8877665544332211U);
    EXPECT_EQ(datagram->header, someHeader());
    EXPECT_EQ(DatagramBytes(datagram->payload.begin(), datagram->payload.end()), payload);
    EXPECT_TRUE(verifying.value().verify(datagram->signed_bytes, datagram->signature));
  }
}

TEST(DatagramTest, EveryByteButTheTokenIsSigned) {
  SigningKey key;
  const auto verifying = VerifyingKey::from(key.verifyingKey());
  const DatagramBytes whole =
      testing::datagramBytes(5, signedBody(someHeader(), DatagramBytes(20, 1), key));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    DatagramBytes bytes = whole;
    bytes[i] ^= 1U;
    const auto datagram = readDatagram(bytes);
    if (!datagram) continue;  // its numbers alone give it away
    EXPECT_EQ(verifying.value().verify(datagram->signed_bytes, datagram->signature),
              i < kTokenBytes)
        << i;
  }
}

TEST(DatagramTest, SizesAndNumbersThatCannotBeAreRefused) {
  SigningKey key;
  const DatagramBytes body =
      signedBody(someHeader(), DatagramBytes(kMostPieceBytes + kSealBytes, 1), key);
  DatagramBytes bytes = testing::datagramBytes(5, body);
  EXPECT_TRUE(readDatagram(bytes));
  bytes.push_back(0);
  EXPECT_FALSE(readDatagram(bytes)) << "longer than a datagram may be";
  for (const std::size_t size : {0U, 8U, 12U, 100U})
    EXPECT_FALSE(readDatagram(std::span(bytes).first(size))) << size;
  DatagramHeader header = someHeader();
  header.part = header.parts;
  EXPECT_FALSE(readDatagram(testing::datagramBytes(5, signedBody(header, {}, key))))
      << "part 9 of 0..8";
  header = someHeader();
  header.media_time = MediaTime(Duration(2'000'000'000'000'000'000));
  EXPECT_FALSE(readDatagram(testing::datagramBytes(5, signedBody(header, {}, key)))) << "63 years";
}

TEST(DatagramTest, AProbeHasTheFullSize) {
  SigningKey key;
  const DatagramBytes bytes = testing::datagramBytes(6, probeBody(77, key));
  EXPECT_EQ(bytes.size(), kMostDatagramBytes);
  const auto probe = readDatagram(bytes);
  ASSERT_TRUE(probe);
  EXPECT_TRUE(probe->header.probe());
  EXPECT_EQ(probe->header.stream, 77U);
  EXPECT_TRUE(
      VerifyingKey::from(key.verifyingKey()).value().verify(probe->signed_bytes, probe->signature));
  DatagramHeader small;
  EXPECT_FALSE(readDatagram(testing::datagramBytes(6, signedBody(small, {}, key))))
      << "proves nothing";
}

TEST(DatagramTest, AnEchoHasTwelveBytes) {
  const Echo echo{0x1122334455667788, 0x99AABBCC};
  const EchoBytes bytes = echoBytes(echo);
  EXPECT_EQ(bytes,
            (EchoBytes{0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 0xCC, 0xBB, 0xAA, 0x99}));
  EXPECT_EQ(readEcho(bytes), echo);
  EXPECT_FALSE(readEcho(std::span(bytes).first(11)));
  EXPECT_FALSE(readEcho(DatagramBytes(13)));
}

}  // namespace
}  // namespace hapticast
