// SPDX-License-Identifier: MIT
#include "common/protocol/signed_frame.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "common/protocol/messages.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/golden_messages.hpp"

namespace hapticast {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t kStream = 0x01234567;

CodedFrame someFrame() { return testing::coded(testing::goldenFrame()); }

VerifyingKey keyOf(const SigningKey& key) { return VerifyingKey::from(key.verifyingKey()).value(); }

TEST(SignedFrame, IsTheFrameWithASignature) {
  SigningKey key;
  const Bytes bytes = *encodeSigned(someFrame(), kStream, key);
  const Bytes plain = encode(someFrame());
  EXPECT_EQ(bytes.size(), plain.size() + kSignatureBytes + 2);
  EXPECT_TRUE(std::equal(plain.begin(), plain.end(), bytes.begin()));
  const auto decoded = decode(bytes);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  EXPECT_EQ(encode(decoded.value()), plain);
  EXPECT_TRUE(verifyFrame(bytes, kStream, keyOf(key)));
}

TEST(SignedFrame, IsValidForItsStreamAndItsKeyOnly) {
  SigningKey key;
  const Bytes bytes = *encodeSigned(someFrame(), kStream, key);
  EXPECT_FALSE(verifyFrame(bytes, kStream + 1, keyOf(key)));
  EXPECT_FALSE(verifyFrame(bytes, kStream, keyOf(SigningKey())));
  EXPECT_FALSE(verifyFrame(encode(someFrame()), kStream, keyOf(key)));
}

TEST(SignedFrame, AChangedBitIsFound) {
  SigningKey key;
  const Bytes bytes = *encodeSigned(someFrame(), kStream, key);
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    Bytes changed = bytes;
    changed[random() % changed.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    EXPECT_FALSE(verifyFrame(changed, kStream, keyOf(key)));
  }
}

TEST(SignedFrame, ASecondFrameInTheMessageIsRefused) {
  // A parser would merge it into the signed one.
  SigningKey key;
  Bytes bytes = *encodeSigned(someFrame(), kStream, key);
  const Bytes second = encode(someFrame());
  bytes.insert(bytes.end(), second.begin(), second.end());
  EXPECT_FALSE(verifyFrame(bytes, kStream, keyOf(key)));
  Bytes front = second;
  const Bytes valid = *encodeSigned(someFrame(), kStream, key);
  front.insert(front.end(), valid.begin(), valid.end());
  EXPECT_FALSE(verifyFrame(front, kStream, keyOf(key)));
}

}  // namespace
}  // namespace hapticast
