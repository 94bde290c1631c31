// SPDX-License-Identifier: MIT
// Reliefs that come over the wire and are not taken: rectangles, slices, sums.
#include "tests/support/golden_messages.hpp"
#include "tests/unit/common/wire_messages.hpp"

namespace hapticast {
namespace {

using testing::goldenFrame;
using testing::refusal;
using testing::roundTrip;
using Bytes = std::vector<std::uint8_t>;

/// The golden frame with one relief of the given slices.
CodedFrame withSlices(PixelRect rect, std::vector<SliceBytes> slices) {
  CodedFrame frame = testing::coded(goldenFrame());
  frame.objects[0].grid = nullptr;
  const std::size_t count = slices.size();
  frame.objects[0].relief =
      std::make_shared<CodedRelief>(CodedRelief{rect, std::move(slices), count});
  return frame;
}

/// The first bytes of a slice that covers these cells.
SliceBytes sliceOf(std::uint8_t x, std::uint8_t y, std::uint8_t w, std::uint8_t h) {
  return {0x0F, x, y, w, h, 0xA3, 0x00, 0x00};
}

TEST(WireRefuses, ReliefsThatDoNotFit) {
  const std::vector<SliceBytes> one{sliceOf(0, 0, 1, 1)};
  EXPECT_NO_THROW(roundTrip(withSlices({1918, 1078, 2, 2}, one)));
  for (const PixelRect& rect :
       {PixelRect{1919, 0, 2, 2}, PixelRect{0, 1079, 2, 2}, PixelRect{-1, 0, 2, 2},
        PixelRect{0, 0, 0, 0}, PixelRect{0, 0, 8, 0}, PixelRect{0, 0, 1921, 2},
        PixelRect{0, -1, 2, 2}})
    EXPECT_EQ(refusal(withSlices(rect, one)), ErrorCode::kMalformed) << rect.u << ' ' << rect.v;
  EXPECT_EQ(refusal(withSlices({0, 0, 8, 8}, {})), ErrorCode::kMalformed) << "no slice";
}

TEST(WireRefuses, SlicesThatDoNotFit) {
  constexpr PixelRect kTwoCells{10, 10, 16, 8};
  const auto with = [&](std::vector<SliceBytes> slices) {
    return withSlices(kTwoCells, std::move(slices));
  };
  EXPECT_NO_THROW(roundTrip(with({sliceOf(0, 0, 1, 1), sliceOf(1, 0, 1, 1)})));
  EXPECT_NO_THROW(roundTrip(with({sliceOf(0, 0, 2, 1)})));
  EXPECT_EQ(refusal(with({sliceOf(1, 0, 2, 1)})), ErrorCode::kMalformed) << "leaves the rectangle";
  EXPECT_EQ(refusal(with({sliceOf(0, 1, 1, 1)})), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(with({sliceOf(0, 0, 0, 1)})), ErrorCode::kMalformed) << "covers nothing";
  EXPECT_EQ(refusal(with({sliceOf(0, 0, 2, 1), sliceOf(1, 0, 1, 1)})), ErrorCode::kMalformed)
      << "overlap";
  EXPECT_EQ(refusal(with({sliceOf(0, 0, 1, 1), sliceOf(0, 0, 1, 1)})), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(with({SliceBytes{0x0F, 0, 0, 1, 1, 0xA3}})), ErrorCode::kMalformed) << "short";
  EXPECT_EQ(refusal(with({SliceBytes{}})), ErrorCode::kMalformed);
  EXPECT_EQ(refusal(with({SliceBytes{0x2F, 0, 0, 1, 1, 0xA3, 0, 0}})), ErrorCode::kMalformed)
      << "mode";
  EXPECT_EQ(refusal(with({SliceBytes{0x0F, 0, 0, 1, 1, 0xA3, 0}})), ErrorCode::kMalformed)
      << "a header without code";
  SliceBytes longest = sliceOf(0, 0, 1, 1);
  longest.resize(kMostSliceBytes, 1);
  EXPECT_NO_THROW(roundTrip(with({longest})));
  longest.push_back(1);
  EXPECT_EQ(refusal(with({longest})), ErrorCode::kTooLarge);
}

TEST(WireRefuses, MoreSlicesThanThereAreCells) {
  constexpr std::size_t kCells = std::size_t{1920 / 8} * (1080 / 8);
  // Slices of no bytes: whatever else is wrong with them is not looked at.
  EXPECT_EQ(refusal(withSlices({0, 0, 8, 8}, std::vector<SliceBytes>(kCells + 1))),
            ErrorCode::kTooLarge);
  // Two reliefs in one object would be merged into one with twice the slices.
  const Bytes relief = {0x22, 14, 0x18, 8, 0x20, 8, 0x4A, 8, 0x0F, 0, 0, 1, 1, 0xA3, 0, 0};
  Bytes object = relief;
  const auto message = [&] {
    Bytes frame = {0x22, static_cast<std::uint8_t>(object.size())};
    frame.insert(frame.end(), object.begin(), object.end());
    Bytes bytes = {0x32, static_cast<std::uint8_t>(frame.size())};
    bytes.insert(bytes.end(), frame.begin(), frame.end());
    return bytes;
  };
  EXPECT_TRUE(decode(message()).ok());
  object.insert(object.end(), relief.begin(), relief.end());
  EXPECT_FALSE(decode(message()).ok());
}

TEST(WireRefuses, BoundsTheSumOfReliefs) {
  HapticFrame frame = goldenFrame();
  frame.objects.resize(1);
  frame.objects[0].grid = nullptr;
  auto large = std::make_shared<Relief>();
  large->rect = {0, 0, 1920, 1080};
  large->mask.assign(std::size_t{1920} * 1080, 0);
  large->mask[77] = 1;
  large->height_mm.assign(std::size_t{1920} * 1080, 1.0F);
  frame.objects[0].relief = large;
  frame.objects.push_back(frame.objects[0]);
  frame.objects[1].id = 2;
  EXPECT_NO_THROW(roundTrip(frame));
  frame.objects.push_back(frame.objects[0]);
  frame.objects[2].id = 3;
  EXPECT_EQ(refusal(frame), ErrorCode::kTooLarge);
}

}  // namespace
}  // namespace hapticast
