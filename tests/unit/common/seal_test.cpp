// SPDX-License-Identifier: MIT
#include "common/transport/seal.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <random>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/transport/datagram.hpp"
#include "tests/support/datagram_bytes.hpp"

namespace hapticast {
namespace {

using SealedBytes = std::vector<std::uint8_t>;

static_assert(!std::is_copy_constructible_v<SealingKey> && !std::is_copy_assignable_v<SealingKey>,
              "a copy would use the same counters again");

SealedBytes randomBytes(std::mt19937& random, std::size_t size) {
  SealedBytes bytes(size);
  for (std::uint8_t& each : bytes) each = static_cast<std::uint8_t>(random());
  return bytes;
}

DatagramHeader headerOf(std::mt19937& random) {
  DatagramHeader header{static_cast<std::uint32_t>(random()), 7, random(), mediaTime(1.5), 0, 9};
  header.part = static_cast<std::uint16_t>(random() % header.parts);
  return header;
}

/// Opens a datagram; empty where it cannot be.
std::optional<SealedBytes> openBytes(const SealedBytes& bytes, const OpeningKey& key) {
  const auto datagram = readDatagram(bytes);
  if (!datagram || datagram->key_id == kPlainKeyId) return std::nullopt;
  SealedBytes payload(datagram->sealed.size() - kSealTagBytes);
  if (!key.open(datagram->counter, datagram->readable, datagram->sealed, payload))
    return std::nullopt;
  return payload;
}

TEST(Seal, OpensASealedDatagramOfAnySize) {
  std::mt19937 random(1);
  SigningKey signer;
  SealingKey seal(9);
  const OpeningKey opening(seal.bytes());
  for (int i = 0; i < 300; ++i) {
    const std::size_t size = i == 0   ? 0
                             : i == 1 ? kMostPieceBytes
                                      : random() % (kMostPieceBytes + 1);
    const SealedBytes payload = randomBytes(random, size);
    const DatagramHeader header = headerOf(random);
    const auto bytes = testing::datagramBytes(5, signedBody(header, payload, signer, &seal));
    EXPECT_EQ(bytes.size(), 101 + 24 + size);
    const auto datagram = readDatagram(bytes);
    ASSERT_TRUE(datagram);
    EXPECT_EQ(datagram->header, header);
    EXPECT_EQ(datagram->key_id, 9);
    EXPECT_EQ(datagram->counter, static_cast<std::uint64_t>(i)) << "one more for each datagram";
    EXPECT_TRUE(datagram->payload.empty()) << "nobody reads it unopened";
    EXPECT_EQ(openBytes(bytes, opening), payload);
  }
}

TEST(Seal, EveryBitButTheTokenIsProtected) {
  std::mt19937 random(2);
  SigningKey signer;
  SealingKey seal(1);
  const OpeningKey opening(seal.bytes());
  const auto good = testing::datagramBytes(
      5, signedBody(headerOf(random), randomBytes(random, 40), signer, &seal));
  ASSERT_TRUE(openBytes(good, opening));
  for (std::size_t bit = 0; bit < 8 * (good.size() - kSignatureBytes); ++bit) {
    SealedBytes bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_EQ(openBytes(bad, opening).has_value(), bit < 8 * kTokenBytes) << bit;
  }
}

TEST(Seal, AnotherKeyOpensNothing) {
  std::mt19937 random(3);
  SigningKey signer;
  SealingKey seal(1);
  const auto bytes = testing::datagramBytes(
      5, signedBody(headerOf(random), randomBytes(random, 9), signer, &seal));
  EXPECT_FALSE(openBytes(bytes, OpeningKey(SealingKey(1).bytes()))) << "a random one";
}

TEST(Seal, NoCounterComesTwiceAndAMoveGoesOn) {
  SealingKey first(3);
  std::set<SealedBytes> counters, ciphertexts;
  const SealedBytes payload(16, 7);
  const auto use = [&](SealingKey& key) {
    SealedBytes out;
    key.seal(out, payload);
    counters.emplace(out.begin(), out.begin() + kSealCounterBytes);
    ciphertexts.emplace(out.begin() + kSealCounterBytes, out.end() - kSealTagBytes);
  };
  for (int i = 0; i < 700; ++i) use(first);
  SealingKey second = std::move(first);
  for (int i = 0; i < 300; ++i) use(second);
  EXPECT_EQ(counters.size(), 1000U);
  EXPECT_EQ(ciphertexts.size(), 1000U) << "the same payload never looks the same";
}

TEST(Seal, KeysAreRandom) {
  std::set<SealKeyBytes> keys;
  for (int i = 0; i < 100; ++i) keys.insert(SealingKey(1).bytes());
  EXPECT_EQ(keys.size(), 100U);
}

TEST(Seal, ADatagramWithoutRoomForItsSealOrAProbeIsRefused) {
  SigningKey signer;
  SealingKey seal(1);
  auto bytes = testing::datagramBytes(6, probeBody(77, signer));
  ASSERT_TRUE(readDatagram(bytes));
  bytes[kTokenBytes + 4] = 1;
  EXPECT_FALSE(readDatagram(bytes)) << "a sealed probe";
  const DatagramHeader header{1, 7, 8, mediaTime(1.5), 0, 1};
  auto small = testing::datagramBytes(6, signedBody(header, SealedBytes(kSealBytes - 1), signer));
  ASSERT_TRUE(readDatagram(small));
  small[kTokenBytes + 4] = 1;
  EXPECT_FALSE(readDatagram(small)) << "no room for counter and tag";
}

}  // namespace
}  // namespace hapticast
