// SPDX-License-Identifier: MIT
#include "server/stream/datagram_sealer.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "server/stream/frame_signer.hpp"
#include "tests/support/manual_clock.hpp"

namespace hapticast::server {
namespace {

using namespace std::chrono_literals;

class DatagramSealerTest : public ::testing::Test {
 protected:
  ManualClock clock;
  DatagramSealer sealer{clock};
};

TEST_F(DatagramSealerTest, AKeyLastsAnHourAndTheNextOneIsAnnouncedASecondBeforeItsUse) {
  const DatagramKey first = sealer.firstKey();
  clock.advance(1h - 1ms);
  EXPECT_FALSE(sealer.rotate());
  clock.advance(1ms);
  const auto second = sealer.rotate();
  ASSERT_TRUE(second);
  EXPECT_NE(second->id, first.id);
  EXPECT_NE(second->bytes, first.bytes);
  EXPECT_EQ(second->grace, 10s);
  clock.advance(999ms);
  EXPECT_FALSE(sealer.rotate()) << "announced once";
  EXPECT_EQ(sealer.key().id(), first.id) << "viewers may not have the new one yet";
  clock.advance(1ms);
  EXPECT_FALSE(sealer.rotate());
  EXPECT_EQ(sealer.key().id(), second->id);
  EXPECT_EQ(sealer.key().bytes(), second->bytes);
  clock.advance(1h);
  EXPECT_TRUE(sealer.rotate());
}

TEST_F(DatagramSealerTest, AfterARevocationTheNextFrameHasANewKey) {
  const DatagramKey first = sealer.firstKey();
  sealer.revoke();
  EXPECT_EQ(sealer.key().id(), first.id) << "the encoder may be using it";
  const auto second = sealer.rotate();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->grace, 1s);
  EXPECT_EQ(sealer.key().id(), second->id) << "used at once";
  EXPECT_NE(second->bytes, first.bytes);
  EXPECT_FALSE(sealer.rotate());
}

TEST_F(DatagramSealerTest, ARevocationDropsAKeyThatIsAnnouncedAlready) {
  clock.advance(1h);
  const auto announced = sealer.rotate();
  ASSERT_TRUE(announced);
  sealer.revoke();
  const auto revoked = sealer.rotate();
  ASSERT_TRUE(revoked);
  EXPECT_NE(revoked->id, announced->id);
  clock.advance(2s);
  EXPECT_FALSE(sealer.rotate());
  EXPECT_EQ(sealer.key().bytes(), revoked->bytes) << "the revoked viewer has the announced one";
}

TEST_F(DatagramSealerTest, IdsStayWithinOneByteAndKeysNeverRepeat) {
  std::set<SealKeyBytes> keys;
  for (int i = 0; i < 600; ++i) {
    sealer.revoke();
    const auto key = sealer.rotate();
    ASSERT_TRUE(key);
    EXPECT_NE(key->id, 0) << "means: not sealed";
    keys.insert(key->bytes);
  }
  EXPECT_EQ(keys.size(), 600U);
}

TEST_F(DatagramSealerTest, ASignerSealsAllDatagramsOrNone) {
  FrameSigner sealing(SigningKey(), std::make_unique<DatagramSealer>(clock));
  FrameSigner plain;
  EXPECT_TRUE(sealing.identity().sealed);
  EXPECT_TRUE(sealing.identity().datagram_key);
  EXPECT_FALSE(plain.identity().sealed);
  EXPECT_FALSE(plain.identity().datagram_key);
  plain.revokeKey();
  EXPECT_FALSE(plain.rotateKey());
  const auto key_id = [](FrameSigner& signer) {
    constexpr std::size_t kKeyIdAt = 4;
    CodedFrame frame;
    frame.objects.emplace_back().id = 1;
    return signer.signDatagrams(frame)->at(0).at(kKeyIdAt);
  };
  EXPECT_EQ(key_id(sealing), 1);
  EXPECT_EQ(key_id(plain), 0);
  sealing.revokeKey();
  ASSERT_TRUE(sealing.rotateKey());
  EXPECT_EQ(key_id(sealing), 2);
}

}  // namespace
}  // namespace hapticast::server
