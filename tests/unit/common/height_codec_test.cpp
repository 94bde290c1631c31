// SPDX-License-Identifier: MIT
// Golden slices: HAPTICAST_UPDATE_GOLDEN=1 unit_common --gtest_filter='HeightCodecGolden.*' writes
// golden/*.slices and the fuzzer's seeds anew; the decoder in proto/examples reads them, too.
#include "common/codec/height_codec.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <limits>
#include <sstream>

#include "tests/support/slice_shapes.hpp"

namespace hapticast {
namespace {

using testing::anyRelief;
using testing::emptyRelief;

// Decodes in the order given; every slice has to be good.
Relief decodedSlices(const std::vector<SliceBytes>& slices, const PixelRect& rect) {
  Relief out = emptyRelief(rect.width, rect.height);
  HeightDecoder decoder;
  for (const SliceBytes& slice : slices) {
    const auto covered = decoder.decode(slice, out);
    EXPECT_TRUE(covered.ok()) << (covered.ok() ? "" : covered.error().message);
  }
  return out;
}

// The mask is exact, the bound holds for every pixel, and nothing stands outside.
void expectWithin(const Relief& was, const Relief& is, double error_mm) {
  double worst = 0.0;
  for (std::size_t i = 0; i < was.mask.size(); ++i) {
    ASSERT_EQ(is.mask[i], was.mask[i] != 0 ? 1 : 0) << "pixel " << i;
    if (is.mask[i] == 0)
      ASSERT_EQ(is.height_mm[i], 0.0F);
    else
      worst = std::max(worst, std::abs(double(is.height_mm[i]) - double(was.height_mm[i])));
  }
  EXPECT_LE(worst, error_mm);
}

void expectRoundTrip(const Relief& relief, const SliceSettings& settings) {
  HeightEncoder encoder;
  const auto slices = encoder.encode(relief, settings);
  for (const SliceBytes& slice : slices) EXPECT_LE(slice.size(), settings.most_bytes);
  // Of large heights a float is itself coarser.
  expectWithin(relief, decodedSlices(slices, relief.rect), settings.error_mm + 4e-5);
}

TEST(HeightCodec, BoundHoldsForEveryPixelOfAnyShape) {
  std::mt19937 random(5);
  for (int i = 0; i < 150; ++i) {
    const int width = 1 + int(random() % 130);
    const int height = 1 + int(random() % 130);
    SliceSettings settings;
    settings.error_mm = std::array{0.002, 0.02, 0.055, 0.2, 0.49}[random() % 5];
    settings.coarse_sixteenths = 1 + int(random() % 16);
    settings.most_bytes = random() % 2 == 0 ? kMostSliceBytes : 400;
    SCOPED_TRACE(i);
    expectRoundTrip(anyRelief(random, width, height), settings);
  }
}

TEST(HeightCodec, SmoothBoundIsHardToTheLastUnit) {
  const Relief relief = testing::dome(240, 240);
  HeightEncoder encoder;
  for (const double error_mm : {0.02, 0.055, 0.2})
    expectWithin(relief, decodedSlices(encoder.encode(relief, {error_mm}), relief.rect), error_mm);
}

TEST(HeightCodec, EverySliceDecodesAloneAndInAnyOrder) {
  std::mt19937 random(6);
  const Relief relief = testing::terraces(200, 150);
  HeightEncoder encoder;
  auto slices = encoder.encode(relief, {0.02, 16, 500});
  ASSERT_GT(slices.size(), 4U);
  const Relief whole = decodedSlices(slices, relief.rect);
  std::shuffle(slices.begin(), slices.end(), random);
  const Relief again = decodedSlices(slices, relief.rect);
  EXPECT_EQ(again.height_mm, whole.height_mm);
  std::size_t covered_px = 0;
  for (const SliceBytes& slice : slices) {
    HeightDecoder fresh;
    Relief alone = emptyRelief(relief.rect.width, relief.rect.height);
    const auto covered = fresh.decode(slice, alone);
    ASSERT_TRUE(covered.ok());
    EXPECT_EQ(HeightDecoder::covers(slice, relief.rect).value(), covered.value());
    for (std::size_t i = 0; i < alone.mask.size(); ++i) {
      if (alone.mask[i] == 0) continue;
      ++covered_px;
      ASSERT_EQ(alone.height_mm[i], whole.height_mm[i]);
    }
  }
  EXPECT_EQ(covered_px, std::size_t(std::count(whole.mask.begin(), whole.mask.end(), 1)));
}

TEST(HeightCodec, EmptyMaskHasNoSlices) {
  HeightEncoder encoder;
  EXPECT_TRUE(encoder.encode(emptyRelief(40, 30)).empty());
}

TEST(HeightCodec, OnePixelAnywhere) {
  for (const auto& [x, y] : {std::pair{0, 0}, {39, 0}, {0, 29}, {39, 29}, {17, 9}}) {
    Relief relief = emptyRelief(40, 30);
    relief.mask[std::size_t(y * 40 + x)] = 1;
    relief.height_mm[std::size_t(y * 40 + x)] = 12.34F;
    HeightEncoder encoder;
    const auto slices = encoder.encode(relief);
    ASSERT_EQ(slices.size(), 1U);
    EXPECT_LT(slices[0].size(), 30U);
    expectWithin(relief, decodedSlices(slices, relief.rect), 0.02);
  }
}

TEST(HeightCodec, NoCellIsLongerThanASlice) {
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    const Relief relief = testing::reliefOf(
        8, 8, [&](int, int) { return random() % 4 == 0 ? -1e3 : double(random() % 1001); });
    expectRoundTrip(relief, {0.002, 16, 400});
  }
}

TEST(HeightCodec, WholePicture) {
  expectRoundTrip(testing::dome(1920, 1080), {});
  expectRoundTrip(testing::reliefOf(1920, 1080, [](int x, int y) { return 0.01 * (x + y % 7); }),
                  {});
}

TEST(HeightCodec, HeightsThatCannotBeAreMadePossible) {
  Relief relief = testing::dome(64, 48);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const auto middle = std::size_t(24 * 64 + 32);
  relief.height_mm[middle] = std::numeric_limits<float>::quiet_NaN();
  relief.height_mm[middle + 1] = kInf;
  relief.height_mm[middle + 2] = -kInf;
  relief.height_mm[middle + 3] = 1e30F;
  HeightEncoder encoder;
  const Relief is = decodedSlices(encoder.encode(relief), relief.rect);
  EXPECT_NEAR(is.height_mm[middle], 0.0F, 0.021F);
  EXPECT_NEAR(is.height_mm[middle + 1], 1000.0F, 0.021F);
  EXPECT_NEAR(is.height_mm[middle + 2], -1.0F, 0.021F);
  EXPECT_NEAR(is.height_mm[middle + 3], 1000.0F, 0.021F);
}

TEST(HeightCodec, RoughDepthIsShorterByItsOwnLevels) {
  const Relief relief = testing::terraces(120, 90);
  HeightEncoder encoder;
  const auto slices = encoder.encode(relief);
  ASSERT_FALSE(slices.empty());
  for (const SliceBytes& slice : slices) EXPECT_EQ(slice[0] >> 4U, 1U);
  expectWithin(relief, decodedSlices(slices, relief.rect), 1e-4);  // the levels are exact
}

// --- bytes from anywhere

// Whatever comes out is a relief that may be touched, or nothing was written.
void expectHarmless(const SliceBytes& slice, HeightDecoder& decoder, Relief& into) {
  const Relief before = into;
  const auto covered = decoder.decode(slice, into);
  if (!covered.ok()) {
    EXPECT_EQ(covered.error().code, ErrorCode::kMalformed);
    EXPECT_EQ(into.mask, before.mask);
    return;
  }
  for (std::size_t i = 0; i < into.mask.size(); ++i) {
    ASSERT_LE(into.mask[i], 1);
    ASSERT_TRUE(into.height_mm[i] >= -1.0F && into.height_mm[i] <= 1000.0F);
  }
}

TEST(HeightCodec, HostileBytesAreHarmless) {
  std::mt19937 random(8);
  HeightEncoder encoder;
  HeightDecoder decoder;
  std::vector<SliceBytes> good;
  for (const Relief& relief : {testing::dome(100, 80), testing::terraces(100, 80)}) {
    for (SliceBytes& slice : encoder.encode(relief)) good.push_back(std::move(slice));
  }
  Relief into = emptyRelief(100, 80);
  for (int i = 0; i < 3000; ++i) {
    SliceBytes bad = good[random() % good.size()];
    for (auto changes = 1 + random() % 4; changes > 0; --changes)
      bad[random() % bad.size()] = std::uint8_t(random());
    if (random() % 3 == 0) bad.resize(random() % bad.size());
    if (random() % 7 == 0) std::generate(bad.begin(), bad.end(), random);
    expectHarmless(bad, decoder, into);
  }
}

TEST(HeightCodec, RefusesBytesThatAreNoSlice) {
  Relief into = emptyRelief(100, 80);
  HeightEncoder encoder;
  const SliceBytes good = encoder.encode(testing::dome(100, 80)).at(0);
  struct Change {
    std::size_t byte;
    int value;
  };
  // Mode, place, size, step.
  for (const Change change :
       {Change{0, 0x2F}, {0, 0xFF}, {1, 1}, {2, 1}, {3, 0}, {3, 14}, {4, 0}, {4, 11}, {6, 16}}) {
    SliceBytes bad = good;
    bad[change.byte] = std::uint8_t(change.value);
    EXPECT_FALSE(HeightDecoder().decode(bad, into).ok()) << change.byte;
    EXPECT_FALSE(HeightDecoder::covers(bad, into.rect).ok()) << change.byte;
  }
  SliceBytes tiny_step = good;
  tiny_step[5] = 8;
  tiny_step[6] = 0;
  EXPECT_FALSE(HeightDecoder().decode(tiny_step, into).ok());
  for (std::size_t size : {std::size_t{0}, std::size_t{6}, good.size() / 2})
    EXPECT_FALSE(HeightDecoder().decode({good.data(), size}, into).ok()) << size;
  EXPECT_EQ(std::count(into.mask.begin(), into.mask.end(), 1), 0);
}

// --- golden

std::uint32_t crc32Of(const void* data, std::size_t size) {
  std::uint32_t crc = 0xFFFFFFFFU;
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    for (int k = 0; k < 8; ++k) crc = crc >> 1U ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

// Mask and heights in 1/4096 mm (4 bytes little-endian each).
std::string crcsOf(const Relief& relief) {
  std::vector<std::int32_t> units;
  units.reserve(relief.height_mm.size());
  for (const float mm : relief.height_mm) units.push_back(std::int32_t(mm * 4096.0F));
  std::ostringstream out;
  out << std::hex << std::setfill('0') << "crc " << std::setw(8)
      << crc32Of(relief.mask.data(), relief.mask.size()) << ' ' << std::setw(8)
      << crc32Of(units.data(), 4 * units.size());
  return out.str();
}

std::string goldenText(const Relief& relief, const std::vector<SliceBytes>& slices) {
  std::ostringstream out;
  out << "rect " << relief.rect.width << ' ' << relief.rect.height << '\n' << std::hex;
  for (const SliceBytes& slice : slices) {
    out << "slice ";
    for (const std::uint8_t byte : slice) out << std::setw(2) << std::setfill('0') << int(byte);
    out << '\n';
  }
  out << crcsOf(decodedSlices(slices, relief.rect)) << '\n';
  return out.str();
}

void writeSeeds(const std::string& name, const Relief& relief,
                const std::vector<SliceBytes>& slices) {
  const auto corpus = std::filesystem::path(HAPTICAST_TESTS) / "fuzz/corpus/slice";
  std::filesystem::create_directories(corpus);
  for (std::size_t i = 0; i < slices.size(); ++i) {
    std::ofstream file(corpus / (name + "_" + std::to_string(i)), std::ios::binary);
    file << char(relief.rect.width - 1) << char(relief.rect.height - 1);
    file.write(reinterpret_cast<const char*>(slices[i].data()), std::streamsize(slices[i].size()));
  }
}

TEST(HeightCodecGolden, SlicesStayAsTheyAre) {
  const Relief bowl = testing::dome(93, 71);
  const Relief steps = testing::terraces(93, 71);
  Relief pixel = emptyRelief(9, 3);
  pixel.mask[9 + 4] = 1;
  pixel.height_mm[9 + 4] = 12.5F;
  // Rows that reach the right border: row 0 ends 2 px before it, rows 1 and 2 at it.
  Relief border = emptyRelief(8, 3);
  for (const int i : {2, 3, 4, 5, 10, 11, 12, 13, 14, 15, 18, 19, 20, 21, 22, 23}) {
    border.mask[static_cast<std::size_t>(i)] = 1;
    border.height_mm[static_cast<std::size_t>(i)] = 12.5F;
  }
  HeightEncoder encoder;
  for (const auto& [name, relief, settings] :
       {std::tuple<std::string, Relief, SliceSettings>{"dome", bowl, {}},
        {"dome_pieces", bowl, {0.055, 12, 300}},
        {"terraces", steps, {0.02, 16, 700}},
        {"pixel", pixel, {0.02, 16}},
        {"border", border, {0.02, 16}}}) {
    const auto slices = encoder.encode(relief, settings);
    const auto file =
        std::filesystem::path(HAPTICAST_TESTS) / "unit/common/golden" / (name + ".slices");
    if (std::getenv("HAPTICAST_UPDATE_GOLDEN") != nullptr) {
      std::ofstream(file) << goldenText(relief, slices);
      writeSeeds(name, relief, slices);
    }
    std::ifstream in(file);
    const std::string golden{std::istreambuf_iterator<char>(in), {}};
    EXPECT_EQ(goldenText(relief, slices), golden) << name;
  }
}

}  // namespace
}  // namespace hapticast
