// SPDX-License-Identifier: MIT
#include "server/stream/send_queue.hpp"

#include <gtest/gtest.h>

#include <string>

namespace hapticast::server {
namespace {

SharedBytes bytes(const std::string& text) {
  return std::make_shared<const std::vector<std::uint8_t>>(text.begin(), text.end());
}
EncodedFrame frame(std::uint64_t id, int media_ms) {
  return {0, id, MediaTime(std::chrono::milliseconds(media_ms)), bytes("lean" + std::to_string(id)),
          std::make_shared<LazyKeyFrame>(bytes("whole" + std::to_string(id)))};
}
EncodedVideo video(std::uint64_t id) {
  return {id, MediaTime(), bytes("video" + std::to_string(id))};
}
std::string pop(SendQueue& queue) {
  const SharedBytes next = queue.pop({});
  return next ? std::string(next->begin(), next->end()) : "nothing";
}

TEST(SendQueue, GivesTheFirstFrameWholeAndTheNextOnesLean) {
  SendQueue queue;
  queue.pushFrame(frame(1, 0));
  queue.pushFrame(frame(2, 40));
  EXPECT_EQ(pop(queue), "whole1");
  EXPECT_EQ(pop(queue), "lean2");
  EXPECT_EQ(pop(queue), "nothing");
  queue.pushFrame(frame(3, 80));
  EXPECT_EQ(pop(queue), "lean3");
  EXPECT_EQ(queue.counts().frames_sent, 3U);
  EXPECT_EQ(queue.counts().dropped(), 0U);
}

TEST(SendQueue, PassesAFrameAsPushAndPopWould) {
  SendQueue queue;
  const auto passed = [&queue](std::uint64_t id) {
    const SharedBytes bytes = queue.pass(frame(id, 0));
    return std::string(bytes->begin(), bytes->end());
  };
  EXPECT_EQ(passed(1), "whole1");
  EXPECT_EQ(passed(2), "lean2");
  queue.clearFrames();
  EXPECT_EQ(passed(3), "whole3");
  EXPECT_EQ(queue.counts().frames_sent, 3U);
  EXPECT_EQ(pop(queue), "nothing");
}

TEST(SendQueue, AfterAnotherPictureTheNextFrameIsWholeAlsoWhereNoneWaited) {
  SendQueue queue;
  queue.pushFrame(frame(1, 0));
  EXPECT_EQ(pop(queue), "whole1");
  queue.clearFrames();
  queue.pushFrame(frame(2, 40));
  EXPECT_EQ(pop(queue), "whole2") << "the viewer has dropped its reliefs";
}

TEST(SendQueue, NewestWinsAndTheNextOneIsWhole) {
  SendQueue queue;
  queue.pushFrame(frame(1, 0));
  EXPECT_EQ(pop(queue), "whole1");
  for (int id = 2; id <= 8; ++id) queue.pushFrame(frame(static_cast<std::uint64_t>(id), 10 * id));
  EXPECT_EQ(pop(queue), "whole6") << "2..5 were dropped";
  EXPECT_EQ(pop(queue), "lean7");
  EXPECT_EQ(pop(queue), "lean8");
  EXPECT_EQ(pop(queue), "nothing");
  EXPECT_EQ(queue.counts().frames_dropped_full, 4U);
}

TEST(SendQueue, DropsFramesThatAreTooOld) {
  SendQueue queue;
  queue.pushFrame(frame(1, 0));
  queue.pushFrame(frame(2, 100));
  queue.pushFrame(frame(3, 251));
  EXPECT_EQ(queue.counts().frames_dropped_old, 1U);
  EXPECT_EQ(pop(queue), "whole2");
  queue.pushFrame(frame(4, 5000));
  EXPECT_EQ(pop(queue), "whole4") << "3 was dropped";
}

TEST(SendQueue, ControlGoesFirstThenDescriptionFramesVideo) {
  SendQueue queue;
  queue.pushVideo(video(1));
  queue.pushFrame(frame(1, 0));
  queue.pushDescription(bytes("old description"));
  queue.pushDescription(bytes("description"));
  ASSERT_TRUE(queue.pushControl(bytes("first")));
  ASSERT_TRUE(queue.pushControl(bytes("second")));
  for (const char* expected : {"first", "second", "description", "whole1", "video1", "nothing"}) {
    EXPECT_EQ(pop(queue), expected);
  }
}

TEST(SendQueue, KeepsOneVideoOnly) {
  SendQueue queue;
  queue.pushVideo(video(1));
  queue.pushVideo(video(2));
  EXPECT_EQ(pop(queue), "video2");
  EXPECT_EQ(pop(queue), "nothing");
  EXPECT_EQ(queue.counts().videos_dropped, 1U);
  EXPECT_EQ(queue.counts().videos_sent, 1U);
}

TEST(SendQueue, NeverGrowsBeyondItsBounds) {
  SendQueue queue;
  for (std::size_t i = 0; i < SendQueue::kMaxControl; ++i)
    EXPECT_TRUE(queue.pushControl(bytes("c")));
  EXPECT_FALSE(queue.pushControl(bytes("c")));
  for (std::uint64_t i = 0; i < 10000; ++i) {
    queue.pushFrame(frame(i, 0));
    queue.pushVideo(video(i));
  }
  std::size_t held = 0;
  while (queue.pop({})) ++held;
  EXPECT_EQ(held, SendQueue::kMaxControl + SendQueue::kMaxFrames + 1);
}

TEST(SendQueue, ForgetsFramesOfAnotherPicture) {
  SendQueue queue;
  queue.pushFrame(frame(1, 0));
  EXPECT_EQ(pop(queue), "whole1");
  queue.pushFrame(frame(2, 40));
  queue.pushVideo(video(2));
  queue.clearFrames();
  EXPECT_EQ(pop(queue), "nothing");
  queue.pushFrame(frame(3, 80));
  EXPECT_EQ(pop(queue), "whole3");
}

}  // namespace
}  // namespace hapticast::server
