// SPDX-License-Identifier: MIT
#include "common/protocol/fragment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <random>

#include "common/protocol/messages.hpp"
#include "tests/support/coded.hpp"
#include "tests/support/golden_messages.hpp"
#include "tests/unit/common/wire_messages.hpp"

namespace hapticast {
namespace {

using Payloads = std::vector<std::vector<std::uint8_t>>;

std::shared_ptr<const MotionGrid> fullGrid(const PixelRect& rect) {
  auto grid = std::make_shared<MotionGrid>();
  grid->columns = gridCells(rect.width);
  grid->rows = gridCells(rect.height);
  for (int i = 0; i < grid->columns * grid->rows; ++i) {
    const auto value = static_cast<float>(i);
    grid->velocity_mm_s.emplace_back(value, -value, 1.0F);
    grid->acceleration_mm_s2.emplace_back(10.0F, value, 2.0F * value);
  }
  return grid;
}

/// Objects of all sizes: rough reliefs of many slices, grids, and some that did not change.
CodedFrame largeFrame(std::uint32_t seed) {
  std::mt19937 random(seed);
  HapticFrame frame = testing::goldenFrame();
  for (std::uint32_t i = 0; i < 6; ++i) {
    HapticObject object = frame.objects[i % 2];
    object.id = 4'000'000'000U + i;
    object.layer = i % 3;
    if (i % 3 != 2) {
      const PixelRect rect{static_cast<int>(random() % 100), 3,
                           20 + static_cast<int>(random() % 150),
                           10 + static_cast<int>(random() % 100)};
      object.relief = std::make_shared<Relief>(
          testing::randomRelief(rect, seed + i, i % 2 == 0 ? 30.0F : 0.5F));
      object.grid = i % 2 == 0 ? fullGrid(rect) : nullptr;
    }
    frame.objects.push_back(object);
  }
  return testing::coded(frame, {});
}

/// The same order of objects and slices, whichever they came in.
CodedFrame sortSlices(CodedFrame frame) {
  std::sort(frame.objects.begin(), frame.objects.end(), [](const auto& a, const auto& b) {
    return std::pair(a.id, a.layer) < std::pair(b.id, b.layer);
  });
  for (CodedObject& object : frame.objects) {
    if (!object.relief) continue;
    auto relief = std::make_shared<CodedRelief>(*object.relief);
    std::sort(relief->slices.begin(), relief->slices.end());
    object.relief = relief;
  }
  return frame;
}

DatagramHeader headerOf(const CodedFrame& frame, std::size_t part, std::size_t parts) {
  return {1,
          frame.epoch,
          frame.id,
          frame.media_time,
          static_cast<std::uint16_t>(part),
          static_cast<std::uint16_t>(parts)};
}

Reassembly joined(const CodedFrame& frame, const Payloads& payloads,
                  const std::vector<std::size_t>& order) {
  Reassembly join(headerOf(frame, order.front(), payloads.size()));
  for (const std::size_t part : order) {
    const DatagramHeader header = headerOf(frame, part, payloads.size());
    EXPECT_TRUE(join.lacks(header));
    const auto error = join.add(header, payloads[part]);
    EXPECT_FALSE(error) << part << ": " << error->message;
    EXPECT_FALSE(join.lacks(header));
  }
  return join;
}

TEST(FramePiecesTest, UnpacksAFrameFromPiecesInAnyOrder) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const CodedFrame frame = largeFrame(seed);
    const Payloads payloads = packFrame(frame);
    ASSERT_GT(payloads.size(), 10U);
    std::vector<std::size_t> order(payloads.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(seed));
    for (const auto& payload : payloads) EXPECT_LE(payload.size(), kMostPieceBytes);
    const Reassembly join = joined(frame, payloads, order);
    EXPECT_TRUE(join.whole());
    const CodedFrame out = join.frame();
    for (const CodedObject& object : out.objects)
      EXPECT_TRUE(!object.relief || object.relief->whole());
    EXPECT_EQ(encode(sortSlices(out)), encode(sortSlices(frame)));
  }
}

TEST(FramePiecesTest, AllReceivedPiecesAreUsable) {
  const CodedFrame frame = largeFrame(9);
  const Payloads payloads = packFrame(frame);
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<std::size_t> order{0};  // the first one has heads
    for (std::size_t i = 1; i < payloads.size(); ++i) {
      if (random() % 3 != 0) order.push_back(i);
    }
    const Reassembly join = joined(frame, payloads, order);
    const CodedFrame out = join.frame();
    EXPECT_EQ(join.whole(), order.size() == payloads.size());
    EXPECT_FALSE(out.objects.empty());
    for (const CodedObject& object : out.objects) {
      if (!object.relief) continue;
      EXPECT_LE(object.relief->slices.size(), object.relief->slice_count);
      (void)testing::decodedRelief(*object.relief);
    }
  }
}

TEST(FramePiecesTest, AReliefGrowsWithEveryFragment) {
  const CodedFrame frame = largeFrame(3);
  const Payloads payloads = packFrame(frame);
  Reassembly join(headerOf(frame, 0, payloads.size()));
  std::size_t joined_slices = 0;
  for (std::size_t part = 0; part < payloads.size(); ++part) {
    ASSERT_FALSE(join.add(headerOf(frame, part, payloads.size()), payloads[part]));
    joined_slices = 0;
    for (const CodedObject& object : frame.objects) {
      const auto relief = join.relief(makeKey(object));
      if (relief) joined_slices += relief->slices.size();
    }
  }
  std::size_t slices = 0;
  for (const CodedObject& object : frame.objects)
    if (object.relief) slices += object.relief->slices.size();
  EXPECT_EQ(joined_slices, slices);
}

TEST(FramePiecesTest, ASmallFrameIsOneDatagram) {
  const CodedFrame golden = testing::coded(testing::goldenFrame());
  EXPECT_EQ(packFrame(golden).size(), 1U);
  const Payloads nothing = packFrame(CodedFrame{});
  ASSERT_EQ(nothing.size(), 1U);
  EXPECT_TRUE(nothing[0].empty());
  EXPECT_TRUE(joined(CodedFrame{}, nothing, {0}).frame().objects.empty());
}

TEST(FramePiecesTest, TheLongestSliceFitsADatagramWithTheLargestNumbers) {
  CodedFrame frame;
  frame.id = ~0ULL;
  CodedObject object;
  object.id = ~0U;
  object.layer = 15;
  object.changed_in_frame = frame.id;
  auto relief = std::make_shared<CodedRelief>();
  relief->rect = {1000, 200, 900, 800};
  relief->slices.assign(20'000, SliceBytes(kMostSliceBytes, 1));
  relief->slice_count = relief->slices.size();
  object.relief = relief;
  frame.objects.push_back(object);
  EXPECT_TRUE(packFrame(frame).empty()) << "22 MB are no frame";
  relief->slices.resize(7'000);
  const Payloads payloads = packFrame(frame);
  EXPECT_EQ(payloads.size(), 7'001U);
  for (const auto& payload : payloads) ASSERT_LE(payload.size(), kMostPieceBytes);
}

TEST(FramePiecesTest, PartsThatContradictEachOtherMakeNoFrame) {
  const CodedFrame frame = largeFrame(4);
  const Payloads payloads = packFrame(frame);
  const DatagramHeader first = headerOf(frame, 0, payloads.size());
  const auto fails = [&](const std::vector<std::uint8_t>& second) {
    Reassembly join(first);
    EXPECT_FALSE(join.add(first, payloads[0]));
    DatagramHeader header = first;
    header.part = 1;
    return join.add(header, second).has_value();
  };
  EXPECT_FALSE(fails(payloads.back()));
  EXPECT_TRUE(fails(payloads[0])) << "the same objects again";
  CodedFrame moved = frame;
  for (CodedObject& object : moved.objects) {
    if (!object.relief) continue;
    auto relief = std::make_shared<CodedRelief>(*object.relief);
    relief->rect.u += 1;
    object.relief = relief;
  }
  EXPECT_TRUE(fails(packFrame(moved).back())) << "a slice of a rectangle elsewhere";
  EXPECT_TRUE(fails({0xFF}));
  Reassembly twice(first);
  EXPECT_FALSE(twice.add(headerOf(frame, 1, payloads.size()), payloads.back()));
  EXPECT_TRUE(twice.add(headerOf(frame, 2, payloads.size()), payloads.back()))
      << "the same slices again";
  Reassembly join(first);
  for (const auto& change : std::vector<std::function<void(DatagramHeader&)>>{
           [](auto& h) { ++h.frame; }, [](auto& h) { ++h.epoch; }, [](auto& h) { ++h.parts; },
           [](auto& h) { h.media_time += Duration(1); }, [](auto& h) { ++h.stream; }}) {
    DatagramHeader other = first;
    change(other);
    EXPECT_FALSE(join.lacks(other));
    EXPECT_TRUE(join.add(other, payloads[0]));
  }
}

/// A frame whose only object has one slice of a relief with this rectangle.
CodedFrame frameOfObject(std::uint32_t id, const PixelRect& rect) {
  CodedFrame frame;
  frame.id = 9;
  CodedObject& object = frame.objects.emplace_back();
  object.id = id;
  object.changed_in_frame = 9;
  object.relief =
      std::make_shared<CodedRelief>(CodedRelief{rect, {{0x0F, 0, 0, 1, 1, 0xA3, 0, 1}}, 1});
  return frame;
}

TEST(FramePiecesTest, TheReliefsOfAFrameAreBoundedTogether) {
  Reassembly join(headerOf(CodedFrame{0, 9, {}, {}}, 0, 3));
  for (std::uint32_t part = 0; part < 3; ++part) {
    const CodedFrame frame = frameOfObject(part + 1, {0, 0, 1920, 1080});
    const auto error = join.add(headerOf(frame, part, 3), packFrame(frame).at(0));
    EXPECT_EQ(error.has_value(), part == 2) << "two full pictures are the most";
    if (error) {
      EXPECT_EQ(error->code, ErrorCode::kTooLarge);
    }
  }
}

TEST(FramePiecesTest, AnObjectHasOneHead) {
  CodedFrame frame = frameOfObject(1, {0, 0, 8, 8});
  frame.objects[0].relief = nullptr;  // so that no slice comes twice
  const auto head = packFrame(frame).at(0);
  Reassembly join(headerOf(frame, 0, 2));
  EXPECT_FALSE(join.add(headerOf(frame, 0, 2), head));
  EXPECT_TRUE(join.add(headerOf(frame, 1, 2), head));
}

TEST(FramePiecesTest, AHeadAnnouncesNoMoreSlicesThanThereAreCells) {
  // An object of 1920 x 1080 px with 32,400 slices, one for each cell.
  std::vector<std::uint8_t> head = {0x22, 0x10, 0x08, 1,    0x18, 9,    0x22, 0x0A, 0x18, 0x80,
                                    0x0F, 0x20, 0xB8, 0x08, 0x50, 0x90, 0xFD, 0x01, 0x28, 1};
  EXPECT_TRUE(readPiece(head, 9).ok());
  ++head[15];
  EXPECT_FALSE(readPiece(head, 9).ok());
}

TEST(FramePiecesTest, AReliefHasNoMoreSlicesThanItsHeadAnnounces) {
  CodedFrame frame = largeFrame(4);
  const Payloads honest = packFrame(frame);
  for (CodedObject& object : frame.objects) {
    if (!object.relief) continue;
    auto relief = std::make_shared<CodedRelief>(*object.relief);
    relief->slices.resize(1);
    object.relief = relief;
  }
  const Payloads few = packFrame(frame);
  Reassembly join(headerOf(frame, 0, honest.size()));
  EXPECT_FALSE(join.add(headerOf(frame, 0, honest.size()), few[0]));
  bool refused = false;
  for (std::size_t part = 1; part < honest.size() && !refused; ++part)
    refused = join.add(headerOf(frame, part, honest.size()), honest[part]).has_value();
  EXPECT_TRUE(refused);
}

TEST(FramePiecesTest, TheCellsOfAPieceEndWithTheGrid) {
  // A cell of an object whose grid has 2 x 1 cells.
  std::vector<std::uint8_t> piece = {0x22, 0x2A, 0x08, 1, 0x2A, 0x24, 0x4A, 0x22, 0x08, 2, 0x10, 1};
  for (const std::uint8_t field :
       std::array<std::uint8_t, 2>{0x1A, 0x22}) {  // velocity, acceleration
    piece.insert(piece.end(), {field, 12});
    piece.insert(piece.end(), 12, 0);
  }
  piece.insert(piece.end(), {0x28, 1, 0x40, 1});
  EXPECT_TRUE(readPiece(piece, 9).ok());
  piece[piece.size() - 3] = 2;
  EXPECT_FALSE(readPiece(piece, 9).ok());
}

TEST(FramePiecesTest, APieceKeepsTheLimitsOfAFrame) {
  EXPECT_FALSE(readPiece(std::vector<std::uint8_t>(kMostPieceBytes + 1), 1).ok());
  CodedFrame many;
  for (std::uint32_t i = 0; i <= kMaxObjects; ++i) {
    many.objects.emplace_back();
    many.objects.back().id = i;
  }
  EXPECT_FALSE(readPiece(packFrame(many)[0], 1).ok()) << "17 objects";
  CodedFrame later;
  later.id = 5;
  later.objects.emplace_back();
  later.objects[0].changed_in_frame = 5;
  EXPECT_TRUE(readPiece(packFrame(later)[0], 5).ok());
  EXPECT_FALSE(readPiece(packFrame(later)[0], 4).ok()) << "changed in a later frame";
  later.objects[0].motion.quality = 2.0;
  EXPECT_FALSE(readPiece(packFrame(later)[0], 5).ok());
}

TEST(FramePiecesTest, AWholeFrameHasNoPiecesOfObjects) {
  // The only object of a piece that is all slices, sent as a frame.
  const CodedFrame frame = largeFrame(2);
  const auto payload = packFrame(frame).back();
  std::vector<std::uint8_t> message{0x32,
                                    static_cast<std::uint8_t>((payload.size() & 0x7FU) | 0x80U),
                                    static_cast<std::uint8_t>(payload.size() >> 7U)};
  message.insert(message.end(), payload.begin(), payload.end());
  ASSERT_GE(payload.size(), 128U);
  EXPECT_FALSE(decode(message).ok());
}

}  // namespace
}  // namespace hapticast
