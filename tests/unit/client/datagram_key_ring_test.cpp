// SPDX-License-Identifier: MIT
#include "client/net/udp/datagram_key_ring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "client/net/udp/udp_socket.hpp"
#include "tests/support/datagram_bytes.hpp"

namespace hapticast::client {
namespace {

using namespace std::chrono_literals;

TEST(CounterWindow, TakesEachCounterOnceInAnyOrder) {
  CounterWindow window;
  std::vector<std::uint64_t> counters(CounterWindow::kCounters);
  for (std::size_t i = 0; i < counters.size(); ++i) counters[i] = i;
  std::shuffle(counters.begin(), counters.end(), std::mt19937(1));
  for (const std::uint64_t each : counters) {
    ASSERT_FALSE(window.has(each)) << each;
    window.add(each);
    ASSERT_TRUE(window.has(each)) << each;
  }
}

// Against a set of all counters that have come.
TEST(CounterWindow, IsASetOfTheNewestCounters) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    CounterWindow window;
    std::set<std::uint64_t> model;
    std::uint64_t newest = 0;
    for (int i = 0; i < 20'000; ++i) {
      const std::uint64_t span = random() % 100 == 0 ? 3 * CounterWindow::kCounters : 300;
      const std::uint64_t top = newest + span / 4;
      const std::uint64_t counter = top - std::min(top, random() % span);
      const bool old = counter <= newest && newest - counter >= CounterWindow::kCounters;
      ASSERT_EQ(window.has(counter), old || model.contains(counter)) << seed << ": " << counter;
      if (window.has(counter)) continue;
      window.add(counter);
      model.insert(counter);
      newest = std::max(newest, counter);
    }
  }
}

TEST(CounterWindow, HasNothingLeftToGiveAfterTheLastCounter) {
  CounterWindow window;
  constexpr std::uint64_t kLast = ~std::uint64_t{0};
  window.add(kLast);
  EXPECT_TRUE(window.has(kLast));
  EXPECT_FALSE(window.has(kLast - 1));
  EXPECT_TRUE(window.has(0));
}

class DatagramKeyRingTest : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kToken = 5;
  static constexpr std::uint32_t kStream = 77;

  static DatagramKey announce(const SealingKey& key, Duration grace = 10s) {
    return {key.id(), key.bytes(), grace};
  }
  std::vector<std::uint8_t> sealed(SealingKey* key) {
    const DatagramHeader header{kStream, 1, 9, mediaTime(1.0), 0, 1};
    const std::vector<std::uint8_t> payload{1, 2, 3};
    return testing::datagramBytes(kToken, signedBody(header, payload, signer, key));
  }
  bool takes(const std::vector<std::uint8_t>& bytes, double now_s = 1.0) {
    const auto taken = verifier.verify(bytes, localTime(now_s),
                                       [](const auto&) { return FrameAssembler::Want::kNew; });
    if (taken) {
      EXPECT_EQ(std::vector(taken->payload.begin(), taken->payload.end()), kPayload);
    }
    return taken.has_value();
  }

  const std::vector<std::uint8_t> kPayload{1, 2, 3};
  SigningKey signer;
  SealingKey first{1}, second{2};
  DatagramKeyRing keys;
  DatagramVerifier verifier{kToken, kStream, VerifyingKey::from(signer.verifyingKey()).value(),
                            keys};
};

TEST_F(DatagramKeyRingTest, OpensUnderTheKeyOfTheWelcomeAndOnlyOnce) {
  keys.begin(announce(first));
  const auto bytes = sealed(&first);
  EXPECT_TRUE(takes(bytes));
  EXPECT_FALSE(takes(bytes)) << "whatever the frame's state is";
  EXPECT_EQ(verifier.counts().received, 1U);
  EXPECT_EQ(verifier.counts().repeated, 1U);
}

TEST_F(DatagramKeyRingTest, NoWayDownAndNoWayUp) {
  EXPECT_TRUE(takes(sealed(nullptr)));
  EXPECT_FALSE(takes(sealed(&first))) << "a stream without a key";
  keys.begin(announce(first));
  EXPECT_FALSE(takes(sealed(nullptr))) << "not sealed, though signed by the server";
  EXPECT_EQ(verifier.counts().not_opened, 2U);
  EXPECT_TRUE(takes(sealed(&first)));
}

TEST_F(DatagramKeyRingTest, AProbeIsNeverSealed) {
  keys.begin(announce(first));
  const auto probe = testing::datagramBytes(kToken, probeBody(kStream, signer));
  EXPECT_TRUE(verifier.verify(probe, localTime(1.0),
                              [](const auto&) { return FrameAssembler::Want::kNew; }));
}

TEST_F(DatagramKeyRingTest, LateDatagramsOfTheKeyBeforeAreGoodForItsGrace) {
  keys.begin(announce(first));
  const auto late = sealed(&first), later = sealed(&first);
  EXPECT_FALSE(takes(sealed(&second), 100.0)) << "not announced yet";
  keys.add(announce(second), localTime(100.0));
  EXPECT_TRUE(takes(sealed(&second), 100.0));
  EXPECT_TRUE(takes(late, 109.9));
  EXPECT_FALSE(takes(later, 110.0));
  EXPECT_TRUE(takes(sealed(&second), 5000.0)) << "the newest one does not expire by itself";
  EXPECT_EQ(verifier.counts().not_opened, 2U);
}

TEST_F(DatagramKeyRingTest, ARevocationShortensTheGraceAndNothingLengthensIt) {
  keys.begin(announce(first));
  keys.add(announce(second, 1s), localTime(100.0));
  const SealingKey third(3);
  keys.add(announce(third, 60s), localTime(100.5));
  EXPECT_TRUE(takes(sealed(&first), 100.9));
  EXPECT_FALSE(takes(sealed(&first), 101.0));
  EXPECT_TRUE(takes(sealed(&second), 160.0));
}

TEST_F(DatagramKeyRingTest, HoldsAFewKeysOnly) {
  keys.begin(announce(first));
  for (std::uint8_t id = 2; id <= 1 + DatagramKeyRing::kMostKeys; ++id)
    keys.add(announce(SealingKey(id), 60s), localTime(1.0));
  EXPECT_FALSE(takes(sealed(&first)));
}

TEST_F(DatagramKeyRingTest, AnIdThatReturnsIsAnotherKey) {
  keys.begin(announce(first));
  SealingKey again(1);
  keys.add(announce(again), localTime(1.0));
  EXPECT_FALSE(takes(sealed(&first))) << "a wrong tag";
  EXPECT_EQ(verifier.counts().not_opened, 1U);
  EXPECT_TRUE(takes(sealed(&again)));
}

TEST_F(DatagramKeyRingTest, AReconnectionKeepsTheReceivedCounters) {
  keys.begin(announce(first));
  const auto bytes = sealed(&first);
  EXPECT_TRUE(takes(bytes));
  keys.begin(announce(first));
  EXPECT_FALSE(takes(bytes)) << "recorded and sent again";
  keys.begin(announce(second));
  EXPECT_FALSE(takes(sealed(&first))) << "a key of the origin before";
  keys.begin(std::nullopt);
  EXPECT_TRUE(takes(sealed(nullptr)));
}

TEST_F(DatagramKeyRingTest, NoBitOfASealedDatagramCanBeChanged) {
  keys.begin(announce(first));
  const auto good = sealed(&first);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bad = good;
    bad[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_FALSE(takes(bad, 1.0 + static_cast<double>(bit))) << bit;
  }
  EXPECT_TRUE(takes(good, 1e5)) << "and none of them has left a trace";
}

}  // namespace
}  // namespace hapticast::client
