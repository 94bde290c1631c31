// SPDX-License-Identifier: MIT
#include "client/net/udp/udp_socket.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

using Want = FrameAssembler::Want;
constexpr std::uint64_t kToken = 0x1122334455667788;
constexpr std::uint32_t kStream = 77;

class DatagramVerifierTest : public ::testing::Test {
 protected:
  static std::vector<std::uint8_t> withToken(std::vector<std::uint8_t> body,
                                             std::uint64_t token = kToken) {
    const TokenBytes front = tokenBytes(token);
    body.insert(body.begin(), front.begin(), front.end());
    return body;
  }
  std::vector<std::uint8_t> datagram(std::uint64_t frame, std::uint32_t stream = kStream) {
    const std::array<std::uint8_t, 3> payload{1, 2, 3};
    return withToken(signedBody({stream, 1, frame, mediaTime(1.0), 0, 1}, payload, key));
  }
  bool takes(const std::vector<std::uint8_t>& bytes, double now_s = 1.0, Want want = Want::kNew) {
    return verifier.verify(bytes, localTime(now_s), [want](const auto&) { return want; })
        .has_value();
  }

  SigningKey key{KeyBytes{5}};
  DatagramKeyRing keys;
  DatagramVerifier verifier{kToken, kStream, VerifyingKey::from(key.verifyingKey()).value(), keys};
};

TEST_F(DatagramVerifierTest, AcceptsDatagramsThatTheServerHasSigned) {
  const auto bytes = datagram(9);
  const auto taken = verifier.verify(bytes, localTime(1), [](const auto&) { return Want::kNew; });
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->header.frame, 9U);
  EXPECT_EQ(taken->payload.size(), 3U);
  EXPECT_EQ(verifier.counts().received, 1U);
}

TEST_F(DatagramVerifierTest, CountsEachCauseApart) {
  EXPECT_FALSE(takes({}));
  EXPECT_FALSE(takes(std::vector<std::uint8_t>(1233, 1)));
  EXPECT_FALSE(takes(datagram(1, kStream + 1)));
  EXPECT_FALSE(takes(withToken(signedBody({kStream, 1, 1, {}, 0, 1}, {}, key), kToken + 1)));
  EXPECT_EQ(verifier.counts().foreign, 4U);
  EXPECT_FALSE(takes(datagram(1), 1.0, Want::kHad));
  EXPECT_FALSE(takes(datagram(1), 1.0, Want::kAstray));
  SigningKey other;
  EXPECT_FALSE(takes(withToken(signedBody({kStream, 1, 1, {}, 0, 1}, {}, other))));
  EXPECT_EQ(verifier.counts().repeated, 1U);
  EXPECT_EQ(verifier.counts().astray, 1U);
  EXPECT_EQ(verifier.counts().forged, 1U);
  EXPECT_EQ(verifier.counts().received, 0U);
}

TEST_F(DatagramVerifierTest, NoByteOfADatagramCanBeChanged) {
  const auto good = datagram(3);
  for (std::size_t i = 0; i < good.size(); ++i) {
    auto bad = good;
    bad[i] ^= 0x10U;
    EXPECT_FALSE(takes(bad)) << i;
  }
  EXPECT_TRUE(takes(good));
}

TEST_F(DatagramVerifierTest, AFloodCostsABoundedNumberOfSignatures) {
  auto forged = datagram(1);
  forged.back() ^= 1U;
  // Ten seconds of 50,000 a second.
  for (int i = 0; i < 500'000; ++i) {
    if (i % 10 == 0) (void)takes(forged, 1.0 + i / 50'000.0);
  }
  EXPECT_LE(verifier.counts().forged,
            10 * DatagramVerifier::kVerifications_Hz + DatagramVerifier::kBurst);
  EXPECT_GT(verifier.counts().over_budget, 20'000U);
  EXPECT_TRUE(takes(datagram(2), 12.0)) << "the flood is over";
}

TEST_F(DatagramVerifierTest, ATimeThatGoesBackGivesNothing) {
  auto forged = datagram(1);
  forged.back() ^= 1U;
  for (int i = 0; i < 2000; ++i) (void)takes(forged, i % 2 == 0 ? 1.0 : 0.0);
  EXPECT_LE(verifier.counts().forged, DatagramVerifier::kBurst);
}

}  // namespace
}  // namespace hapticast::client
