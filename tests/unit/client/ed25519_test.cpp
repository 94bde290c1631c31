// SPDX-License-Identifier: MIT
// The page's verification of signatures against OpenSSL.
#include "client/web/ed25519.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <string_view>
#include <vector>

#include "client/web/sha512.hpp"
#include "common/transport/signature.hpp"

namespace hapticast::client {
namespace {

std::vector<std::uint8_t> fromHex(std::string_view hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(
        static_cast<std::uint8_t>(std::stoul(std::string(hex.substr(i, 2)), nullptr, 16)));
  return bytes;
}

bool verifyHere(std::span<const std::uint8_t> bytes, const Signature& signature,
                const KeyBytes& key) {
  const auto point = ed25519::decodePoint(key);
  return point && ed25519::verify(bytes, signature, key, *point);
}

bool verifyByOpenSsl(std::span<const std::uint8_t> bytes, const Signature& signature,
                     const KeyBytes& key) {
  const auto made = VerifyingKey::from(key);
  return made.ok() && made.value().verify(bytes, signature);
}

std::vector<std::uint8_t> drawBytes(std::mt19937_64& random, std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

KeyBytes drawKey(std::mt19937_64& random) {
  KeyBytes key{};
  for (std::uint8_t& byte : key) byte = static_cast<std::uint8_t>(random());
  return key;
}

TEST(Ed25519Signature, HashesAsFips180Says) {
  const std::string_view text = "abc";
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  const std::array<std::span<const std::uint8_t>, 2> parts{bytes.first(1), bytes.subspan(1)};
  const auto hash = computeSha512(parts);
  EXPECT_EQ(std::vector<std::uint8_t>(hash.begin(), hash.end()),
            fromHex("ddaf35a193617abacc417349ae20413112e6fa4e89a97ea20a9eeee64b55d39a"
                    "2192992a274fc1a836ba3c23a3feebbd454d4423643ce80e2a9ac94fa54ca49f"));
}

TEST(Ed25519Signature, AcceptsTheSignaturesOfOpenSsl) {
  std::mt19937_64 random(52);
  for (int i = 0; i < 100; ++i) {
    SigningKey key(drawKey(random));
    const auto bytes = drawBytes(random, static_cast<std::size_t>(i) * 7);
    EXPECT_TRUE(verifyHere(bytes, key.sign(bytes), key.verifyingKey())) << i;
  }
}

TEST(Ed25519Signature, AgreesWithOpenSslOnChangedBytes) {
  std::mt19937_64 random(53);
  SigningKey key(drawKey(random));
  for (int i = 0; i < 400; ++i) {
    auto bytes = drawBytes(random, 50);
    Signature signature = key.sign(bytes);
    KeyBytes shown = key.verifyingKey();
    const std::size_t bit = random() % (std::size_t{8} * (64 + 32 + 50));
    std::uint8_t& place = bit < 512   ? signature[bit / 8]
                          : bit < 768 ? shown[(bit - 512) / 8]
                                      : bytes[(bit - 768) / 8];
    place = static_cast<std::uint8_t>(place ^ (1U << (bit % 8)));
    EXPECT_EQ(verifyHere(bytes, signature, shown), verifyByOpenSsl(bytes, signature, shown)) << i;
    EXPECT_FALSE(verifyHere(bytes, signature, shown)) << i;
  }
}

/// Adds the order of the base point to the second half: the same number modulo the order.
Signature addOrder(Signature signature) {
  const auto order = fromHex("edd3f55c1a631258d69cf7a2def9de1400000000000000000000000000000010");
  unsigned over = 0;
  for (std::size_t i = 0; i < 32; ++i) {
    over += signature[32 + i] + unsigned{order[i]};
    signature[32 + i] = static_cast<std::uint8_t>(over);
    over >>= 8U;
  }
  return signature;
}

TEST(Ed25519Signature, RefusesASecondFormOfASignature) {
  std::mt19937_64 random(54);
  SigningKey key(drawKey(random));
  const auto bytes = drawBytes(random, 40);
  const Signature other = addOrder(key.sign(bytes));
  EXPECT_FALSE(verifyHere(bytes, other, key.verifyingKey()));
  EXPECT_FALSE(verifyByOpenSsl(bytes, other, key.verifyingKey()));
}

// Encodings of points of small order and of numbers of p or more (RFC 8032 allows none of them in
// an honest signature). With such a key and R, a signature may be valid for many texts.
TEST(Ed25519Signature, AgreesWithOpenSslOnStrangePoints) {
  std::vector<KeyBytes> points;
  for (const char* const hex :
       {"0100000000000000000000000000000000000000000000000000000000000000",
        "ecffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
        "0000000000000000000000000000000000000000000000000000000000000000",
        "0000000000000000000000000000000000000000000000000000000000000080",
        "0100000000000000000000000000000000000000000000000000000000000080",
        "26e8958fc2b227b045c3f489f2ef98f0d5dfac05d3c63339b13802886d53fc05",
        "c7176a703d4dd84fba3c0b760d10670f2a2053fa2c39ccc64ec7fd7792ac037a",
        "edffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
        "eeffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff7f",
        "eeffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff",
        "ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff"}) {
    const auto bytes = fromHex(hex);
    std::copy(bytes.begin(), bytes.end(), points.emplace_back().begin());
  }
  std::mt19937_64 random(55);
  int accepted = 0;
  for (const KeyBytes& key : points)
    for (const KeyBytes& r : points)
      for (int i = 0; i < 8; ++i) {
        Signature signature{};  // s = 0
        std::copy(r.begin(), r.end(), signature.begin());
        const auto bytes = drawBytes(random, 8);
        const bool expected = verifyByOpenSsl(bytes, signature, key);
        EXPECT_EQ(verifyHere(bytes, signature, key), expected);
        accepted += expected ? 1 : 0;
      }
  EXPECT_GT(accepted, 10) << "the test reaches valid ones";
}

TEST(Ed25519Signature, AgreesWithOpenSslOnRandomBytes) {
  std::mt19937_64 random(56);
  for (int i = 0; i < 200; ++i) {
    const KeyBytes key = drawKey(random);
    Signature signature{};
    for (std::uint8_t& byte : signature) byte = static_cast<std::uint8_t>(random());
    EXPECT_EQ(verifyHere({}, signature, key), verifyByOpenSsl({}, signature, key));
  }
}

}  // namespace
}  // namespace hapticast::client
