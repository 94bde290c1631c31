// SPDX-License-Identifier: MIT
#include "client/net/frame_assembler.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

HapticFrame frameOf(std::uint64_t id, std::uint32_t epoch = 0) {
  HapticFrame frame;
  frame.id = id;
  frame.epoch = epoch;
  frame.media_time = mediaTime(0.04 * static_cast<double>(id));
  return frame;
}

TEST(FrameAssembler, PutsFramesInTheirPlace) {
  FrameAssembler assembler;
  assembler.restart();
  const auto first = assembler.add(frameOf(10));
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->place.first);
  EXPECT_EQ(first->place.lost, 0U);
  const auto second = assembler.add(frameOf(14));
  ASSERT_TRUE(second);
  EXPECT_FALSE(second->place.first);
  EXPECT_EQ(second->place.lost, 3U);
  EXPECT_EQ(second->place.gap, mediaTime(0.56) - mediaTime(0.40));
  EXPECT_EQ(second->place.media_time, mediaTime(0.56));
  EXPECT_EQ(second->frame.id, 14U);
}

TEST(FrameAssembler, DropsWhatCameBeforeOrTooLate) {
  FrameAssembler assembler;
  assembler.restart();
  EXPECT_TRUE(assembler.add(frameOf(5)));
  EXPECT_FALSE(assembler.add(frameOf(5)));
  EXPECT_FALSE(assembler.add(frameOf(4)));
  EXPECT_TRUE(assembler.add(frameOf(6)));
}

TEST(FrameAssembler, EpochsRiseWithTheServersAndWithEveryConnection) {
  FrameAssembler assembler;
  assembler.restart();
  const std::uint32_t begin = assembler.epoch();
  EXPECT_EQ(assembler.add(frameOf(1, 7))->place.epoch, begin) << "whatever the server's is";
  EXPECT_EQ(assembler.add(frameOf(2, 7))->place.epoch, begin);
  EXPECT_EQ(assembler.add(frameOf(3, 8))->place.epoch, begin + 1);
  EXPECT_EQ(assembler.add(frameOf(4, 7))->place.epoch, begin + 2) << "an old number, a new epoch";
  assembler.restart();
  const auto again = assembler.add(frameOf(1, 7));
  ASSERT_TRUE(again) << "ids start over";
  EXPECT_EQ(again->place.epoch, begin + 3);
  EXPECT_TRUE(again->place.first);
}

}  // namespace
}  // namespace hapticast::client
