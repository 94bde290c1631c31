// SPDX-License-Identifier: MIT
// A folder of images that plays forwards, then backwards.
#include <gtest/gtest.h>

#include <string>

#include "server/source/folder/image_sequence.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

/// 16-bit depth: 1000 mm + frame.
void fill(const SourceFolder& folder, int frames) {
  const cv::Size size(32, 24);
  for (int i = 0; i < frames; ++i) {
    const std::string name = std::to_string(i) + ".png";
    folder.write("rgb/" + name, cv::Mat(size, CV_8UC3, cv::Scalar::all(10 * i)));
    folder.write("depth/" + name, cv::Mat(size, CV_16UC1, cv::Scalar(1000 + i)));
  }
}

TEST(ToAndFro, PlaysForwardsAndBackwards) {
  const SourceFolder folder;
  fill(folder, 5);
  ImageSequence source(folder.string(), 0.0, true);
  EXPECT_EQ(source.info().frame_count, 8U);
  for (int round = 0; round < 2; ++round) {
    std::uint64_t index = 0;
    for (const int i : {0, 1, 2, 3, 4, 3, 2, 1}) {
      const auto frame = source.read();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->index, index++);
      EXPECT_EQ(frame->depth.at<float>(0, 0), 1000.0F + static_cast<float>(i));
    }
    EXPECT_FALSE(source.read());
    source.rewind();
  }
}

TEST(ToAndFro, OneOrTwoImagesHaveNoWayBack) {
  const SourceFolder folder;
  for (const int frames : {1, 2}) {
    fill(folder, frames);
    ImageSequence source(folder.string(), 0.0, true);
    EXPECT_EQ(source.info().frame_count, static_cast<std::uint64_t>(frames));
  }
}

}  // namespace
}  // namespace hapticast::server
