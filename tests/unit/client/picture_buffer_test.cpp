// SPDX-License-Identifier: MIT
#include "client/view/picture.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace hapticast::client {
namespace {

VideoFrame pictureAt(double time_s, std::size_t bytes = 3) {
  return {0, 0, mediaTime(time_s), std::vector<std::uint8_t>(bytes, 1)};
}

double timeOf(const std::shared_ptr<const StreamPicture>& picture) {
  return toSeconds(picture->video.media_time);
}

TEST(PictureBuffer, FindsThePictureNearestInTime) {
  PictureBuffer buffer;
  EXPECT_EQ(buffer.findNearest(mediaTime(1.0)), nullptr);
  Workspace wide;
  wide.width_px = 1280;
  buffer.add(pictureAt(1.0), Workspace{});
  buffer.add(pictureAt(2.0), wide);
  EXPECT_EQ(timeOf(buffer.findNearest(mediaTime(-5.0))), 1.0);
  EXPECT_EQ(timeOf(buffer.findNearest(mediaTime(1.4))), 1.0);
  EXPECT_EQ(timeOf(buffer.findNearest(mediaTime(1.6))), 2.0);
  EXPECT_EQ(buffer.findNearest(mediaTime(9.0))->workspace, wide) << "the one it came with";
}

TEST(PictureBuffer, ForgetsTheOldestBeyondItsBounds) {
  PictureBuffer many;
  for (std::size_t i = 0; i < 2 * PictureBuffer::kMaxPictures; ++i) {
    many.add(pictureAt(static_cast<double>(i)), Workspace{});
  }
  EXPECT_EQ(timeOf(many.findNearest(mediaTime(0.0))), double{PictureBuffer::kMaxPictures});

  PictureBuffer large;
  for (int i = 0; i < 5; ++i) {
    large.add(pictureAt(i, PictureBuffer::kMaxBytes / 2 - 1), Workspace{});
  }
  EXPECT_EQ(timeOf(large.findNearest(mediaTime(0.0))), 3.0) << "only two fit";
  large.add(pictureAt(5.0, PictureBuffer::kMaxBytes + 1), Workspace{});
  EXPECT_EQ(timeOf(large.findNearest(mediaTime(0.0))), 5.0) << "the newest stays whatever its size";
}

TEST(PictureBuffer, AServerThatStartedAnewTakesNothingFromTheOneBefore) {
  PictureBuffer buffer;
  buffer.add(pictureAt(100.0), Workspace{});
  buffer.add(pictureAt(0.0), Workspace{});
  EXPECT_EQ(timeOf(buffer.findNearest(mediaTime(100.0))), 0.0);
}

TEST(PictureBuffer, IsFilledByOneThreadAndReadByAnother) {
  PictureBuffer buffer;
  std::jthread network([&] {
    for (int i = 0; i < 2000; ++i) buffer.add(pictureAt(i), Workspace{});
  });
  double last_s = 0.0;
  while (last_s < 1999.0) {
    if (const auto picture = buffer.findNearest(mediaTime(2000.0))) {
      EXPECT_GE(timeOf(picture), last_s);
      last_s = timeOf(picture);
    }
  }
}

}  // namespace
}  // namespace hapticast::client
