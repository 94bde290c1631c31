// SPDX-License-Identifier: MIT
// Masks that the author drew for a few frames of a folder: which frames have them, and what is
// refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/haptic_frame.hpp"
#include "server/source/folder/image_sequence.hpp"
#include "server/source/picture/image_file.hpp"
#include "server/vision/base/frame_pair.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(ToMask, NumbersOfObjectsStayAndOtherMasksAreBlackAndWhite) {
  cv::Mat raw = cv::Mat::zeros(2, 2, CV_8UC1);
  raw.at<unsigned char>(0, 0) = 1;
  raw.at<unsigned char>(0, 1) = kMaxObjects;
  EXPECT_EQ(cv::countNonZero(toMask(raw).image != raw), 0);
  raw.at<unsigned char>(0, 1) = kMaxObjects + 1;
  EXPECT_EQ(cv::countNonZero(toMask(raw).image), 0);
  raw.at<unsigned char>(0, 1) = 255;
  EXPECT_EQ(cv::countNonZero(toMask(raw).image), 1);
}

/// Five pictures, 0.png to 4.png.
class KeyMasks : public ::testing::Test {
 protected:
  KeyMasks() {
    for (int i = 0; i < 5; ++i) {
      const std::string name = std::to_string(i) + ".png";
      folder.write("rgb/" + name, cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(10 * i)));
      folder.write("depth/" + name, cv::Mat(24, 32, CV_16UC1, cv::Scalar(1000)));
    }
  }
  void draw(const std::string& file, const cv::Mat& mask) const {
    folder.write("mask/" + file, mask);
  }
  void refuses(const std::string& file, const std::string& why) const {
    EXPECT_THAT(openError(folder.string()), AllOf(HasSubstr("mask/" + file), HasSubstr(why)));
  }
  static cv::Mat box() {
    cv::Mat mask = cv::Mat::zeros(24, 32, CV_8UC1);
    mask(cv::Rect(4, 5, 6, 7)).setTo(255);
    return mask;
  }
  SourceFolder folder;
};

TEST_F(KeyMasks, AreFewerThanPicturesAndNamedLikeThem) {
  draw("1.png", box());
  draw("3.png", box());
  ImageSequence source(folder.string(), 0.0);
  EXPECT_TRUE(source.info().key_masks);
  for (int i = 0; i < 5; ++i) {
    const auto frame = source.read();
    ASSERT_TRUE(frame);
    const bool has_key = i == 1 || i == 3;
    EXPECT_EQ(frame->mask.empty(), !has_key) << i;
    const FrameImages images = makeFrameImages(*frame, source.info());
    EXPECT_TRUE(images.mask.empty()) << "a key mask is no mask of the source's";
    ASSERT_EQ(images.key_mask.empty(), !has_key) << i;
    if (has_key) {
      EXPECT_EQ(cv::countNonZero(images.key_mask == 1), 42);
    }
  }
}

TEST_F(KeyMasks, AsManyAsPicturesAreTheSources) {
  for (int i = 0; i < 5; ++i) draw("m" + std::to_string(i) + ".png", box());
  ImageSequence source(folder.string(), 0.0);
  EXPECT_FALSE(source.info().key_masks);
  const auto frame = source.read();
  ASSERT_TRUE(frame);
  EXPECT_EQ(cv::countNonZero(makeFrameImages(*frame, source.info()).mask), 42);
  EXPECT_TRUE(makeFrameImages(*frame, source.info()).key_mask.empty());
}

TEST_F(KeyMasks, BadOnesAreRefusedWhereverTheyAre) {
  draw("7.png", box());
  refuses("7.png", "no colour image has this name; name a key mask like its picture");
  std::filesystem::remove(folder / "mask/7.png");
  draw("3.png", cv::Mat(12, 16, CV_8UC1, cv::Scalar(255)));
  refuses("3.png", "is 16x12, but the clip's colour is 32x24; mend it");
  draw("3.png", cv::Mat::zeros(24, 32, CV_8UC1));
  refuses("3.png", "shows no object; draw it in white on black");
  draw("3.png", cv::Mat(24, 32, CV_8UC3, cv::Scalar::all(255)));
  refuses("3.png", "is not an 8-bit grey image; mend it");
  draw("3.png", box());
  draw("3.jpg", box());
  refuses("3.", "is a second key mask of one picture; remove one");
}

}  // namespace
}  // namespace hapticast::server
