// SPDX-License-Identifier: MIT
#include "client/net/frame_assembler.hpp"

#include <gtest/gtest.h>

namespace hapticast::client {
namespace {

CodedFrame frameOf(std::uint64_t id, std::uint32_t epoch = 0) {
  CodedFrame frame;
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

TEST(FrameAssembler, OneAbsurdIdDoesNotSilenceTheStream) {
  FrameAssembler assembler;
  assembler.restart();
  const std::uint32_t begin = assembler.epoch();
  ASSERT_TRUE(assembler.add(frameOf(81)));
  CodedFrame absurd = frameOf(82);
  absurd.id = ~std::uint64_t{0};
  const auto jumped = assembler.add(absurd);
  ASSERT_TRUE(jumped);
  EXPECT_TRUE(jumped->place.resync);
  EXPECT_FALSE(jumped->place.first);
  EXPECT_EQ(jumped->place.lost, 0U) << "18446744073709551534 frames were never there";
  EXPECT_EQ(jumped->place.epoch, begin + 1);
  const auto back = assembler.add(frameOf(83));
  ASSERT_TRUE(back) << "the stream goes on";
  EXPECT_TRUE(back->place.resync);
  EXPECT_EQ(back->place.epoch, begin + 2);
  EXPECT_FALSE(assembler.add(frameOf(84))->place.resync);
}

TEST(FrameAssembler, WhatANetworkDoesIsNoJump) {
  FrameAssembler assembler;
  assembler.restart();
  constexpr std::uint64_t kJump = FrameAssembler::kLargestJump;
  ASSERT_TRUE(assembler.add(frameOf(10)));
  const auto far = assembler.add(frameOf(10 + kJump));
  EXPECT_FALSE(far->place.resync);
  EXPECT_EQ(far->place.lost, kJump - 1);
  EXPECT_FALSE(assembler.add(frameOf(10))) << "a straggler";
  EXPECT_TRUE(assembler.add(frameOf(9))->place.resync) << "numbers that began anew";
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
