// SPDX-License-Identifier: MIT
// How pictures of colour and depth find each other. The cameras run in tests/openni/camera_test.cpp
// and tests/v4l2/camera_test.cpp.
#include "server/source/live/paired_camera.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace hapticast::server {
namespace {

/// A picture of one pixel with its time in ms as its value.
LivePicture pictureAt(bool is_depth, int ms) {
  return {is_depth, localTime(1e-3 * ms), cv::Mat(1, 1, CV_32S, cv::Scalar(ms)), ""};
}

/// The times of the pair that this picture completes, or {-1, -1}.
std::pair<int, int> add(PicturePairer& pairer, bool is_depth, int ms) {
  const auto pair = pairer.push(pictureAt(is_depth, ms));
  if (!pair) return {-1, -1};
  return {pair->color.at<int>(0), pair->depth.at<int>(0)};
}

constexpr std::pair<int, int> kNone{-1, -1};

TEST(PicturePairer, PairsThatAreAtMostHalfAFrameApart) {
  PicturePairer pairer(25.0);  // 40 ms a frame
  EXPECT_EQ(add(pairer, false, 0), kNone);
  EXPECT_EQ(add(pairer, true, 20), std::pair(0, 20));
  EXPECT_EQ(add(pairer, true, 41), kNone);
  EXPECT_EQ(add(pairer, false, 40), std::pair(40, 41));
}

TEST(PicturePairer, TakesTheNearerNeighbour) {
  PicturePairer pairer(25.0);
  // Depth comes 30 ms after a colour and 10 ms before the next one.
  EXPECT_EQ(add(pairer, false, 0), kNone);
  EXPECT_EQ(add(pairer, true, 30), kNone);
  EXPECT_EQ(add(pairer, false, 40), std::pair(40, 30));
  EXPECT_EQ(add(pairer, true, 70), kNone);
  EXPECT_EQ(add(pairer, false, 80), std::pair(80, 70));
}

TEST(PicturePairer, UsesNoPictureTwice) {
  PicturePairer pairer(25.0);
  EXPECT_EQ(add(pairer, false, 0), kNone);
  EXPECT_EQ(add(pairer, true, 1), std::pair(0, 1));
  EXPECT_EQ(add(pairer, true, 2), kNone);
  EXPECT_EQ(add(pairer, true, 3), kNone);
  EXPECT_EQ(add(pairer, false, 4), std::pair(4, 3));
}

}  // namespace
}  // namespace hapticast::server
