// SPDX-License-Identifier: MIT
// The datagrams that proto/datagrams.md takes apart, byte by byte: HAPTICAST_UPDATE_GOLDEN=1
// unit_common --gtest_filter='DatagramGolden*' writes golden/datagram.hex and
// golden/sealed_datagram.hex anew. proto/examples/open_datagram.py reads them, too.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <numeric>
#include <sstream>
#include <string>

#include "common/protocol/fragment.hpp"
#include "tests/support/datagram_bytes.hpp"

namespace hapticast {
namespace {

const std::filesystem::path kTests = HAPTICAST_TESTS;

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

SigningKey exampleKey() {
  KeyBytes seed{};
  std::iota(seed.begin(), seed.end(), std::uint8_t{0});
  return SigningKey(seed);
}

SealKeyBytes exampleSealKey() {
  SealKeyBytes bytes{};
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0xA0});
  return bytes;
}

std::vector<std::uint8_t> exampleDatagram(SealingKey* seal = nullptr) {
  SigningKey key = exampleKey();
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

/// The pairs of digits that a line begins with.
std::vector<std::uint8_t> bytesOfLine(const std::string& line) {
  std::vector<std::uint8_t> bytes;
  std::istringstream words(line);
  for (std::string word; words >> word && word.size() == 2;) {
    if (word.find_first_not_of("0123456789abcdef") != std::string::npos) break;
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(word, nullptr, 16)));
  }
  return bytes;
}

/// The code block behind a line of a file.
std::vector<std::uint8_t> blockBehind(const std::filesystem::path& file, const std::string& mark) {
  std::ifstream in(file);
  std::vector<std::uint8_t> bytes;
  std::string line;
  while (std::getline(in, line) && line != mark) {
  }
  while (std::getline(in, line) && line != "```") {
  }
  while (std::getline(in, line) && line != "```") {
    const auto more = bytesOfLine(line);
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return bytes;
}

void expectGolden(const std::vector<std::uint8_t>& bytes, const std::string& name) {
  const auto file = kTests / "unit/common/golden" / name;
  if (std::getenv("HAPTICAST_UPDATE_GOLDEN") != nullptr) {
    std::ofstream out(file);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      constexpr const char* kDigits = "0123456789abcdef";
      out << kDigits[bytes[i] >> 4U] << kDigits[bytes[i] & 15U] << (i % 16 == 15 ? '\n' : ' ');
    }
    out << '\n';
  }
  std::ifstream in(file);
  std::vector<std::uint8_t> golden;
  for (std::string line; std::getline(in, line);) {
    const auto more = bytesOfLine(line);
    golden.insert(golden.end(), more.begin(), more.end());
  }
  EXPECT_EQ(bytes, golden) << name;
}

TEST(DatagramGoldenTest, BytesStayAsTheyAre) {
  expectGolden(exampleDatagram(), "datagram.hex");
  expectGolden(sealedExample(), "sealed_datagram.hex");
}

TEST(DatagramGoldenTest, ThePageShowsThem) {
  EXPECT_EQ(blockBehind(kTests / "../proto/datagrams.md", "## A datagram, byte by byte"),
            exampleDatagram());
  EXPECT_EQ(blockBehind(kTests / "../proto/datagrams.md", "### A sealed datagram, byte by byte"),
            sealedExample());
  std::ostringstream key;
  const KeyBytes verifying = exampleKey().verifyingKey();
  for (const std::uint8_t byte : verifying)
    key << std::hex << std::setw(2) << std::setfill('0') << int{byte};
  std::ifstream page(kTests / "../proto/datagrams.md");
  EXPECT_NE(std::string(std::istreambuf_iterator<char>(page), {}).find(key.str()),
            std::string::npos);
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
