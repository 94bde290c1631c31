// SPDX-License-Identifier: MIT
#include "client/haptics/playback/frame_pool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <set>
#include <thread>
#include <vector>

namespace hapticast::client {
namespace {

TEST(FramePool, HandsOutEverySlotOnceAndNoMore) {
  const auto pool = std::make_unique<FramePool>();
  std::set<FramePool::Index> seen;
  FramePool::Index index = 0;
  while (pool->acquire(index)) seen.insert(index);
  EXPECT_EQ(seen.size(), FramePool::kSlots);
  EXPECT_FALSE(pool->acquire(index));
}

TEST(FramePool, KeepsTheOrderAndGetsSlotsBack) {
  const auto pool = std::make_unique<FramePool>();
  std::mt19937 random(1);
  std::vector<FramePool::Index> held;
  std::uint64_t sent = 0;
  std::uint64_t taken = 0;
  for (int step = 0; step < 20000; ++step) {
    FramePool::Index index = 0;
    if (random() % 2 == 0 && pool->acquire(index)) {
      pool->slot(index).frame.id = ++sent;
      pool->publish(index);
    }
    if (random() % 3 == 0 && pool->pop(index)) {
      ASSERT_EQ(pool->frame(index).id, ++taken);
      held.push_back(index);
    }
    if (random() % 2 == 0 && !held.empty()) {
      const std::size_t which = random() % held.size();
      pool->release(held[which]);
      held.erase(held.begin() + static_cast<std::ptrdiff_t>(which));
    }
  }
  EXPECT_GT(taken, 5000U);
}

TEST(FramePool, AFreeSlotKeepsNoData) {
  const auto pool = std::make_unique<FramePool>();
  std::vector<std::weak_ptr<const HeightField>> fields;
  FramePool::Index index = 0;
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(pool->acquire(index));
    const auto field = std::make_shared<const HeightField>();
    pool->slot(index).fields[0] = field;
    fields.push_back(field);
    pool->publish(index);
    if (i < 3) continue;  // the loop holds three frames
    ASSERT_TRUE(pool->pop(index));
    pool->release(index);
    const auto alive = std::count_if(fields.begin(), fields.end(),
                                     [](const auto& each) { return !each.expired(); });
    EXPECT_LE(alive, 5);
  }
}

TEST(FramePool, CrossesThreadsWithoutTearing) {
  const auto pool = std::make_unique<FramePool>();
  constexpr std::uint64_t kFrames = 20000;
  std::thread receiver([&] {
    for (std::uint64_t id = 1; id <= kFrames;) {
      FramePool::Index index = 0;
      if (!pool->acquire(index)) {
        std::this_thread::yield();
        continue;
      }
      PlayFrame& frame = pool->slot(index).frame;
      frame.id = id;
      frame.objects[kMaxObjects - 1].changed_in_frame = id++;
      pool->publish(index);
    }
  });
  for (std::uint64_t expected = 1; expected <= kFrames;) {
    FramePool::Index index = 0;
    if (!pool->pop(index)) {
      std::this_thread::yield();
      continue;
    }
    EXPECT_EQ(pool->frame(index).id, expected);
    EXPECT_EQ(pool->frame(index).objects[kMaxObjects - 1].changed_in_frame, expected++);
    pool->release(index);
  }
  receiver.join();
}

}  // namespace
}  // namespace hapticast::client
