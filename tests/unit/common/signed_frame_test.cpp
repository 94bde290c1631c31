// SPDX-License-Identifier: MIT
// Signed frames. Golden bytes: HAPTICAST_UPDATE_GOLDEN=1 unit_common
// --gtest_filter='SignedFrameGolden.*' writes golden/signed_frame.hex and the fuzzer's seed anew.
// proto/frame.md, "Signature", has the key, the number of the stream and the signature.
#include "common/protocol/signed_frame.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "common/protocol/messages.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/golden_bytes.hpp"
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

constexpr std::uint32_t kGoldenStream = 0x89ABCDEF;

TEST(SignedFrameGolden, TheSignerWritesTheSameBytes) {
  SigningKey key = testing::goldenSigningKey();
  const Bytes bytes = *encodeSigned(someFrame(), kGoldenStream, key);
  testing::expectGolden("signed_frame", bytes);
  if (testing::updatesGolden())
    testing::writeBytes(testing::testsFolder() / "fuzz/corpus/wire/signed_frame", bytes);
}

TEST(SignedFrameGolden, IsDecodedAndHasAValidSignature) {
  const Bytes bytes = testing::readGolden("signed_frame");
  const auto decoded = decode(bytes);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  EXPECT_EQ(encode(decoded.value()), testing::readGolden("frame"));
  EXPECT_TRUE(verifyFrame(bytes, kGoldenStream, keyOf(testing::goldenSigningKey())));
}

TEST(SignedFrameGolden, ThePageShowsKeyAndSignature) {
  const auto page = testing::testsFolder() / "../proto/frame.md";
  EXPECT_TRUE(testing::pageHas(page, toHex(testing::goldenSigningKey().verifyingKey())));
  Bytes bytes = testing::readGolden("signed_frame");
  const std::size_t frame_bytes = testing::readGolden("frame").size();
  EXPECT_TRUE(testing::pageHas(page, std::to_string(frame_bytes) + " bytes of `frame.hex`"));
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(frame_bytes));
  EXPECT_EQ(testing::readBlockBehind(page, "## Signature"), bytes);
}

}  // namespace
}  // namespace hapticast
