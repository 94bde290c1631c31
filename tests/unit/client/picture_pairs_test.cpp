// SPDX-License-Identifier: MIT
// Frames and their pictures: a picture goes to the frame of its media time, and no frame waits for
// one that cannot come any more.
#include "client/library/receive/picture_pairs.hpp"

#include <gtest/gtest.h>

#include <random>

namespace hapticast::client {
namespace {

constexpr std::size_t kMostLater = PicturePairs::kMostLater;

MediaTime timeOfPair(std::uint64_t number) { return mediaTime(5.0 + 0.04 * double(number)); }

Frame makeUnpaired(std::uint64_t number) {
  Frame frame;
  frame.id = number + 1000;
  frame.time_s = toSeconds(timeOfPair(number));
  return frame;
}

/// A recorded picture has no id.
VideoFrame makePictureOf(std::uint64_t number) {
  return {0, 0, timeOfPair(number), {static_cast<std::uint8_t>(number)}};
}

std::vector<Frame> takeAll(PicturePairs& pairs) {
  std::vector<Frame> frames;
  while (auto frame = pairs.next()) frames.push_back(std::move(*frame));
  return frames;
}

TEST(PicturePairs, AFrameWaitsForItsPicture) {
  PicturePairs pairs(true);
  for (std::uint64_t i = 0; i < 3; ++i) pairs.add(makeUnpaired(i));
  EXPECT_FALSE(pairs.next());
  pairs.add(makePictureOf(1));
  const auto frames = takeAll(pairs);
  ASSERT_EQ(frames.size(), 2U) << "pictures have the order of their frames";
  EXPECT_TRUE(frames[0].jpeg.empty());
  EXPECT_EQ(frames[1].jpeg, std::vector<std::uint8_t>{1});
  pairs.finish();
  ASSERT_EQ(takeAll(pairs).size(), 1U);
  EXPECT_FALSE(pairs.next());
}

TEST(PicturePairs, APictureMayArriveBeforeItsFrame) {
  PicturePairs pairs(true);
  for (std::uint64_t i = 0; i < kMostLater + 2; ++i) pairs.add(makePictureOf(i));
  for (std::uint64_t i = 1; i < kMostLater + 2; ++i) {
    pairs.add(makeUnpaired(i));
    const auto frames = takeAll(pairs);
    // The first two pictures were too many.
    ASSERT_EQ(frames.size(), i == 1 ? 0U : i == 2 ? 2U : 1U);
    if (!frames.empty()) {
      EXPECT_EQ(frames.back().jpeg, std::vector<std::uint8_t>{static_cast<std::uint8_t>(i)});
    }
  }
}

TEST(PicturePairs, AFrameGoesWithoutAfterLaterOnes) {
  for (const bool has_pictures : {false, true}) {
    PicturePairs pairs(has_pictures);
    for (std::uint64_t i = 0; i < 10; ++i) {
      pairs.add(makeUnpaired(i));
      const std::size_t waits = has_pictures ? kMostLater : 0;
      const auto frames = takeAll(pairs);
      ASSERT_EQ(frames.size(), i < waits ? 0U : 1U);
      if (!frames.empty()) {
        EXPECT_EQ(frames[0].id, 1000 + i - waits);
      }
    }
  }
}

TEST(PicturePairs, EachFrameComesOnceWithNoOtherPicture) {
  std::mt19937 random(11);
  for (int run = 0; run < 200; ++run) {
    PicturePairs pairs(true);
    constexpr std::uint64_t kFrames = 60;
    const std::uint64_t ahead = random() % 3, lost = 2 + random() % 5;
    std::vector<Frame> frames;
    std::uint64_t next_picture = 0;
    for (std::uint64_t i = 0; i < kFrames; ++i) {
      const std::uint64_t until = i + random() % (ahead + 1);
      for (; next_picture < until; ++next_picture)
        if (next_picture % lost != 0) pairs.add(makePictureOf(next_picture));
      pairs.add(makeUnpaired(i));
      for (Frame& each : takeAll(pairs)) frames.push_back(std::move(each));
    }
    pairs.finish();
    for (Frame& each : takeAll(pairs)) frames.push_back(std::move(each));
    ASSERT_EQ(frames.size(), kFrames);
    for (std::uint64_t i = 0; i < kFrames; ++i) {
      EXPECT_EQ(frames[i].id, 1000 + i);
      const bool has_picture = i % lost != 0 && i < next_picture;
      ASSERT_EQ(frames[i].jpeg.size(), has_picture ? 1U : 0U) << i;
      if (has_picture) {
        EXPECT_EQ(frames[i].jpeg[0], i);
      }
    }
  }
}

}  // namespace
}  // namespace hapticast::client
