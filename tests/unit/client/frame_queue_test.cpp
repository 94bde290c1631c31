// SPDX-License-Identifier: MIT
#include "client/net/frame_preparer.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace hapticast::client {
namespace {

CodedObject objectOf(std::uint32_t id, std::uint64_t changed, std::size_t bytes) {
  auto relief = std::make_shared<CodedRelief>();
  relief->slices.emplace_back(bytes);
  return {id, 0, changed, bytes > 0 ? std::move(relief) : nullptr, {}, nullptr, {}, {}};
}

AssembledFrame frameWith(std::uint64_t id, std::vector<CodedObject> objects = {}) {
  AssembledFrame assembled;
  assembled.frame.id = id;
  assembled.frame.objects = std::move(objects);
  return assembled;
}

TEST(FrameQueue, GivesFramesInTheirOrder) {
  FrameQueue queue;
  EXPECT_TRUE(queue.empty());
  EXPECT_FALSE(queue.pop());
  EXPECT_EQ(queue.push(frameWith(1)), 0U);
  EXPECT_EQ(queue.push(frameWith(2)), 0U);
  EXPECT_EQ(queue.pop()->assembled.frame.id, 1U);
  EXPECT_EQ(queue.pop()->assembled.frame.id, 2U);
  EXPECT_TRUE(queue.empty());
}

TEST(FrameQueue, AHeldBackFrameLeavesTheAssemblerLater) {
  FrameQueue queue;
  (void)queue.push(frameWith(1));
  queue.holdBack(fromSeconds(0.03));
  (void)queue.push(frameWith(2));
  queue.holdBack(fromSeconds(0.01));
  EXPECT_EQ(queue.pop()->assembled.place.left, localTime(0.04));
  EXPECT_EQ(queue.pop()->assembled.place.left, localTime(0.01));
}

TEST(FrameQueue, KeepsTheNewestFramesAndTheReliefsOfDroppedOnes) {
  FrameQueue queue;
  (void)queue.push(frameWith(1, {objectOf(7, 1, 4), objectOf(8, 1, 4)}));
  (void)queue.push(frameWith(2, {objectOf(7, 2, 5), objectOf(8, 1, 0)}));
  for (std::uint64_t id = 3; id < 3 + FrameQueue::kMaxFrames; ++id) {
    EXPECT_EQ(queue.push(frameWith(id)), id <= FrameQueue::kMaxFrames ? 0U : 1U);
  }
  const auto taken = queue.pop();
  EXPECT_EQ(taken->assembled.frame.id, 3U);
  ASSERT_EQ(taken->left_out.size(), 2U) << "one for each object";
  EXPECT_EQ(taken->left_out[0].id, 8U);
  EXPECT_EQ(taken->left_out[0].changed_in_frame, 1U);
  EXPECT_EQ(taken->left_out[1].id, 7U);
  EXPECT_EQ(taken->left_out[1].changed_in_frame, 2U) << "the newer relief of the two";
  EXPECT_TRUE(queue.pop()->left_out.empty());
}

TEST(FrameQueue, IsBoundedByBytesToo) {
  FrameQueue queue;
  constexpr std::size_t kHalf = FrameQueue::kMaxBytes / 2;
  EXPECT_EQ(queue.push(frameWith(1, {objectOf(1, 1, kHalf)})), 0U);
  EXPECT_EQ(queue.push(frameWith(2, {objectOf(2, 2, kHalf)})), 0U);
  EXPECT_EQ(queue.push(frameWith(3, {objectOf(3, 3, kHalf)})), 1U);
  EXPECT_EQ(queue.push(frameWith(4, {objectOf(4, 4, kHalf)})), 1U);
  EXPECT_EQ(queue.push(frameWith(5, {objectOf(5, 5, kHalf)})), 1U);
  const auto taken = queue.pop();
  EXPECT_EQ(taken->assembled.frame.id, 4U);
  ASSERT_EQ(taken->left_out.size(), 2U) << "what is kept is bounded as well; the newest stay";
  EXPECT_EQ(taken->left_out[0].id, 2U);
  EXPECT_EQ(taken->left_out[1].id, 3U);
}

TEST(FrameQueue, APoppedFrameGivesItsBytesBack) {
  FrameQueue queue;
  for (std::uint64_t id = 1; id <= 10; ++id) {
    EXPECT_EQ(queue.push(frameWith(id, {objectOf(1, id, FrameQueue::kMaxBytes / 2)})), 0U);
    const auto popped = queue.pop();
    ASSERT_TRUE(popped);
    EXPECT_TRUE(popped->left_out.empty());
  }
}

TEST(FrameQueue, KeepsReliefsOfNoMoreObjectsThanTheCacheDoes) {
  FrameQueue queue;
  const std::uint64_t count = FrameQueue::kMaxFrames + 2 * ReliefCache::kMaxEntries;
  for (std::uint64_t id = 1; id <= count; ++id) {
    (void)queue.push(frameWith(id, {objectOf(static_cast<std::uint32_t>(id), id, 1)}));
  }
  const auto taken = queue.pop();
  EXPECT_EQ(taken->left_out.size(), ReliefCache::kMaxEntries);
  EXPECT_EQ(taken->left_out.back().id + 1, taken->assembled.frame.objects[0].id);
}

TEST(FrameQueue, ResetForgetsEverything) {
  FrameQueue queue;
  for (std::uint64_t id = 1; id <= FrameQueue::kMaxFrames + 1; ++id) {
    (void)queue.push(frameWith(id, {objectOf(1, id, FrameQueue::kMaxBytes / 40)}));
  }
  const Workspace workspace{.width_px = 64, .height_px = 48};
  queue.reset(workspace);
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.push(frameWith(1, {objectOf(1, 1, FrameQueue::kMaxBytes)})), 0U);
  const auto first = queue.pop();
  EXPECT_TRUE(first->left_out.empty());
  EXPECT_EQ(first->begins, workspace) << "the first frame of another stream";
  (void)queue.push(frameWith(2));
  EXPECT_FALSE(queue.pop()->begins);
}

}  // namespace
}  // namespace hapticast::client
