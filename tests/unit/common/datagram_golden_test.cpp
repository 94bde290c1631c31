// SPDX-License-Identifier: MIT
// The datagrams that proto/datagrams.md takes apart, byte by byte: HAPTICAST_UPDATE_GOLDEN=1
// unit_common --gtest_filter='DatagramGolden*' writes golden/datagram.hex and
// golden/sealed_datagram.hex anew. proto/examples/open_datagram.py reads them, too.
#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "common/protocol/fragment.hpp"
#include "tests/support/datagram_bytes.hpp"
#include "tests/support/golden_bytes.hpp"
#include "tests/support/golden_messages.hpp"

namespace hapticast {
namespace {

/// Its one object has the slice that the page's section on slices ends with.
CodedFrame exampleFrame() {
  CodedFrame frame{3, 1000, mediaTime(40.04), {}};
  CodedObject& object = frame.objects.emplace_back();
  object.id = 7;
  object.changed_in_frame = 1000;
  object.motion.position_mm = {1.5, -2.5, 12.0};
  object.motion.velocity_mm_s = {100.0, 0.0, 0.0};
  object.motion.reference_point = ReferencePoint::kCentreOfMass;
  auto relief = std::make_shared<CodedRelief>();
  relief->rect = {100, 50, 9, 3};
  relief->slices = {{0x0F, 0, 0, 1, 1, 0xA3, 0, 0x32, 0xDF, 0x3D, 0xAB, 0x1E, 0xC8}};
  relief->slice_count = 1;
  object.relief = relief;
  return frame;
}

SealKeyBytes exampleSealKey() {
  SealKeyBytes bytes{};
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0xA0});
  return bytes;
}

std::vector<std::uint8_t> exampleDatagram(SealingKey* seal = nullptr) {
  SigningKey key = testing::goldenSigningKey();
  const CodedFrame frame = exampleFrame();
  const auto payloads = packFrame(frame);
  EXPECT_EQ(payloads.size(), 1U);
  const DatagramHeader header{0x89ABCDEF, frame.epoch, frame.id, frame.media_time, 0, 1};
  return testing::datagramBytes(0x0123456789ABCDEF, signedBody(header, payloads[0], key, seal));
}

/// The second datagram under its key, so that its counter is 1.
std::vector<std::uint8_t> sealedExample() {
  SealingKey seal(7, exampleSealKey());
  (void)exampleDatagram(&seal);
  return exampleDatagram(&seal);
}

TEST(DatagramGoldenTest, BytesStayAsTheyAre) {
  testing::expectGolden("datagram", exampleDatagram());
  testing::expectGolden("sealed_datagram", sealedExample());
}

TEST(DatagramGoldenTest, ThePageShowsThem) {
  const auto page = testing::testsFolder() / "../proto/datagrams.md";
  EXPECT_EQ(testing::readBlockBehind(page, "## A datagram, byte by byte"), exampleDatagram());
  EXPECT_EQ(testing::readBlockBehind(page, "### A sealed datagram, byte by byte"), sealedExample());
  EXPECT_TRUE(testing::pageHas(page, toHex(testing::goldenSigningKey().verifyingKey())));
}

TEST(DatagramGoldenTest, IsDecodedToItsFields) {
  const auto bytes = exampleDatagram();
  const auto datagram = readDatagram(bytes);
  ASSERT_TRUE(datagram);
  Reassembly join(datagram->header);
  EXPECT_FALSE(join.add(datagram->header, datagram->payload));
  ASSERT_TRUE(join.whole());
  const CodedFrame frame = join.frame();
  EXPECT_EQ(frame.media_time, mediaTime(40.04));
  ASSERT_EQ(frame.objects.size(), 1U);
  EXPECT_EQ(frame.objects[0].motion.position_mm, Vec3(1.5, -2.5, 12.0));
  EXPECT_EQ(*frame.objects[0].relief, *exampleFrame().objects[0].relief);
}

TEST(DatagramGoldenTest, TheSealedOneHasTheSamePayload) {
  const auto plain = exampleDatagram(), bytes = sealedExample();
  const auto datagram = readDatagram(bytes);
  ASSERT_TRUE(datagram);
  EXPECT_EQ(datagram->key_id, 7);
  EXPECT_EQ(datagram->counter, 1U);
  std::vector<std::uint8_t> payload(datagram->sealed.size() - kSealTagBytes);
  ASSERT_TRUE(OpeningKey(exampleSealKey())
                  .open(datagram->counter, datagram->readable, datagram->sealed, payload));
  const auto expected = readDatagram(plain)->payload;
  EXPECT_EQ(payload, std::vector<std::uint8_t>(expected.begin(), expected.end()));
}

}  // namespace
}  // namespace hapticast
