// SPDX-License-Identifier: MIT
#include "server/vision/describe.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/scenes/ball_scene.hpp"

namespace hapticast::server {
namespace {

TEST(Picture, ComesBackAsTheSamePicture) {
  const cv::Mat color = test::BallScene{}.frame(0, 100, 100).color;
  const std::vector<std::uint8_t> fine = encodePicture(color, 95);
  const cv::Mat back = cv::imdecode(fine, cv::IMREAD_COLOR);
  ASSERT_EQ(back.size(), color.size());
  EXPECT_LT(cv::norm(back, color, cv::NORM_L1) / double(color.total() * 3), 3.0);
  EXPECT_LT(encodePicture(color, 30).size(), fine.size());
}

TEST(Picture, OfNothingIsEmpty) {
  EXPECT_TRUE(encodePicture({}, 80).empty());
  EXPECT_TRUE(encodePicture(cv::Mat(4, 4, CV_32FC1), 80).empty());
  EXPECT_FALSE(encodePicture(cv::Mat::zeros(4, 4, CV_8UC3), 1000).empty());
}

}  // namespace
}  // namespace hapticast::server
