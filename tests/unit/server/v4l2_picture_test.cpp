// SPDX-License-Identifier: MIT
// Buffers as Video4Linux2 devices deliver them: right ones and wrong ones.
#include "server/source/live/v4l2_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <opencv2/imgcodecs.hpp>
#include <utility>
#include <vector>

namespace hapticast::server {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

/// A buffer of `size` bytes that repeats `pattern`.
Bytes repeat(const Bytes& pattern, std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = pattern[i % pattern.size()];
  return bytes;
}

/// A JPEG picture of one colour.
Bytes jpegOf(cv::Size size, const cv::Scalar& bgr) {
  Bytes bytes;
  EXPECT_TRUE(cv::imencode(".jpg", cv::Mat(size, CV_8UC3, bgr), bytes));
  return bytes;
}

/// Red in BT.601 with limited range: Y 81, U 90, V 240.
void expectRed(const ImageResult& result, cv::Size size) {
  ASSERT_TRUE(result.ok()) << result.problem;
  ASSERT_EQ(result.image.size(), size);
  ASSERT_EQ(result.image.type(), CV_8UC3);
  for (const cv::Point at : {cv::Point(0, 0), cv::Point(size) - cv::Point(1, 1)}) {
    const auto pixel = result.image.at<cv::Vec3b>(at);
    EXPECT_NEAR(pixel[0], 0, 3);
    EXPECT_NEAR(pixel[1], 0, 3);
    EXPECT_NEAR(pixel[2], 254, 3);
  }
}

TEST(V4l2Picture, DepthIsExactInMillimetres) {
  const Bytes bytes{0x20, 0x03, 0x21, 0x03, 0, 0, 0xFF, 0xFF};  // 800, 801, 0, 65535
  for (const std::uint32_t code : {fourCc("Z16 "), fourCc("Y16 ")}) {
    const ImageResult depth = readV4l2Depth({code, 2, 2, 0}, bytes);
    ASSERT_TRUE(depth.ok()) << depth.problem;
    ASSERT_EQ(depth.image.type(), CV_32FC1);
    EXPECT_EQ(depth.image.at<float>(0, 0), 800.0F);
    EXPECT_EQ(depth.image.at<float>(0, 1), 801.0F);
    EXPECT_EQ(depth.image.at<float>(1, 0), 0.0F);
    EXPECT_EQ(depth.image.at<float>(1, 1), 65535.0F);
  }
}

TEST(V4l2Picture, RowsMayHaveGapsOfAnyLength) {
  // Two rows of two pixels, 5 bytes apart; the last row has no gap behind it.
  const Bytes bytes{0x20, 0x03, 0x21, 0x03, 99, 0x22, 0x03, 0x23, 0x03};
  const ImageResult depth = readV4l2Depth({fourCc("Z16 "), 2, 2, 5}, bytes);
  ASSERT_TRUE(depth.ok()) << depth.problem;
  EXPECT_EQ(depth.image.at<float>(1, 0), 802.0F);
  EXPECT_EQ(depth.image.at<float>(1, 1), 803.0F);

  Bytes wide = repeat({81, 90, 81, 240}, std::size_t{2} * 12);
  for (const std::size_t gap : {8U, 9U, 10U, 11U, 20U, 21U, 22U, 23U}) wide[gap] = 0;
  expectRed(readV4l2Color({fourCc("YUYV"), 4, 2, 12}, wide), {4, 2});

  Bytes planes(std::size_t{3} * 6,
               0);  // NV12, 4x2 with rows of 6 bytes: two of brightness, one of colours
  for (const std::size_t at : {0U, 1U, 2U, 3U, 6U, 7U, 8U, 9U}) planes[at] = 81;
  for (const std::size_t at : {12U, 14U}) planes[at] = 90;
  for (const std::size_t at : {13U, 15U}) planes[at] = 240;
  expectRed(readV4l2Color({fourCc("NV12"), 4, 2, 6}, planes), {4, 2});
}

TEST(V4l2Picture, EachColorFormatIsRead) {
  expectRed(readV4l2Color({fourCc("YUYV"), 64, 48, 0},
                          repeat({81, 90, 81, 240}, std::size_t{2} * 64 * 48)),
            {64, 48});
  Bytes nv12 = repeat({81}, std::size_t{64} * 48);
  const Bytes colors = repeat({90, 240}, std::size_t{64} * 24);
  nv12.insert(nv12.end(), colors.begin(), colors.end());
  expectRed(readV4l2Color({fourCc("NV12"), 64, 48, 0}, nv12), {64, 48});
  Bytes jpeg = jpegOf({64, 48}, {0, 0, 254});
  expectRed(readV4l2Color({fourCc("MJPG"), 64, 48, 0}, jpeg), {64, 48});
  jpeg.resize(jpeg.size() + 1000);  // drivers deliver more bytes than the picture has
  expectRed(readV4l2Color({fourCc("JPEG"), 64, 48, 0}, jpeg), {64, 48});
}

TEST(V4l2Picture, FormatsOfVirtualCamerasAreRead) {
  const std::size_t pixels = std::size_t{64} * 48;
  expectRed(readV4l2Color({fourCc("UYVY"), 64, 48, 0}, repeat({90, 81, 240, 81}, 2 * pixels)),
            {64, 48});
  expectRed(readV4l2Color({fourCc("BGR3"), 64, 48, 0}, repeat({0, 0, 254}, 3 * pixels)), {64, 48});
  expectRed(readV4l2Color({fourCc("RGB3"), 64, 48, 0}, repeat({254, 0, 0}, 3 * pixels)), {64, 48});
  Bytes planes(pixels, 81);
  planes.resize(pixels + pixels / 4, 90);
  planes.resize(pixels + pixels / 2, 240);
  expectRed(readV4l2Color({fourCc("YU12"), 64, 48, 0}, planes), {64, 48});
  EXPECT_THAT(readV4l2Color({fourCc("YU12"), 64, 46, 66}, planes).problem, HasSubstr("gaps"));
  planes.pop_back();
  EXPECT_EQ(readV4l2Color({fourCc("YU12"), 64, 48, 0}, planes).problem,
            "delivers 4607 bytes instead of 4608");
}

TEST(V4l2Picture, GreyDepthIsHeight) {
  const ImageResult grey = readV4l2Depth({fourCc("GREY"), 2, 2, 3}, Bytes{0, 1, 99, 254, 255});
  ASSERT_TRUE(grey.ok()) << grey.problem;
  ASSERT_EQ(grey.image.type(), CV_32FC1);
  EXPECT_EQ(grey.image.at<float>(0, 1), 1.0F);
  EXPECT_EQ(grey.image.at<float>(1, 1), 255.0F);
  const ImageResult three = readV4l2Depth({fourCc("RGB3"), 2, 1, 0}, Bytes{7, 7, 7, 9, 9, 9});
  ASSERT_TRUE(three.ok()) << three.problem;
  EXPECT_EQ(three.image.at<float>(0, 1), 9.0F);
  EXPECT_FALSE(readV4l2Depth({fourCc("RGB3"), 2, 1, 0}, Bytes{255, 0, 0, 0, 255, 0}).ok())
      << "false colours are no depth";
  EXPECT_EQ(findDepthKind(fourCc("GREY")), DepthKind::kHeight);
  EXPECT_EQ(findDepthKind(fourCc("Y16 ")), DepthKind::kMetric);
}

TEST(V4l2Picture, ShortBuffersAreRefused) {
  const Bytes bytes(2 * 64 * 48 - 1);
  EXPECT_EQ(readV4l2Depth({fourCc("Z16 "), 64, 48, 0}, bytes).problem,
            "delivers 6143 bytes instead of 6144");
  EXPECT_EQ(readV4l2Color({fourCc("YUYV"), 64, 48, 0}, bytes).problem,
            "delivers 6143 bytes instead of 6144");
  EXPECT_EQ(readV4l2Color({fourCc("NV12"), 64, 48, 0}, Bytes(4607)).problem,
            "delivers 4607 bytes instead of 4608");
  EXPECT_EQ(readV4l2Depth({fourCc("Z16 "), 64, 48, 127}, bytes).problem,
            "delivers rows of 127 bytes instead of 128");
  EXPECT_FALSE(readV4l2Depth({fourCc("Z16 "), 64, 48, 0xFFFFFFFF}, bytes).ok());
  EXPECT_FALSE(readV4l2Depth({fourCc("Z16 "), 64, 48, 0}, {}).ok());
  EXPECT_FALSE(readV4l2Color({fourCc("MJPG"), 64, 48, 0}, {}).ok());
}

TEST(V4l2Picture, SizesAreCheckedFirst) {
  const Bytes bytes(100);
  for (const auto& [width, height] : {std::pair{0U, 48U},
                                      {64U, 0U},
                                      {1921U, 48U},
                                      {64U, 1081U},
                                      {0xFFFFFFFFU, 0xFFFFFFFFU},
                                      {0x80000000U, 2U}}) {
    EXPECT_THAT(readV4l2Depth({fourCc("Z16 "), width, height, 0}, bytes).problem,
                HasSubstr("up to 1920x1080"));
    EXPECT_THAT(readV4l2Color({fourCc("YUYV"), width, height, 0}, bytes).problem,
                HasSubstr("up to 1920x1080"));
    EXPECT_FALSE(readV4l2Color({fourCc("MJPG"), width, height, 0}, bytes).ok());
  }
  // Half a pixel of colour does not exist.
  EXPECT_FALSE(readV4l2Color({fourCc("YUYV"), 3, 2, 0}, bytes).ok());
  EXPECT_FALSE(readV4l2Color({fourCc("NV12"), 4, 3, 0}, bytes).ok());
}

TEST(V4l2Picture, AJpegOfAnotherSizeOrACutOneIsRefused) {
  Bytes jpeg = jpegOf({64, 48}, {0, 0, 254});
  EXPECT_EQ(readV4l2Color({fourCc("MJPG"), 640, 480, 0}, jpeg).problem,
            "delivers a JPEG picture of 64x48 instead of 640x480");
  jpeg.resize(jpeg.size() - 20);
  EXPECT_EQ(readV4l2Color({fourCc("MJPG"), 64, 48, 0}, jpeg).problem,
            "delivers a JPEG picture that is cut off");
  EXPECT_EQ(readV4l2Color({fourCc("MJPG"), 64, 48, 0}, Bytes(50, 7)).problem,
            "delivers no whole JPEG picture");
}

TEST(V4l2Picture, OtherFormatsAreRefused) {
  const Bytes bytes(std::size_t{2} * 4 * 4);
  EXPECT_FALSE(readV4l2Color({fourCc("Z16 "), 4, 4, 0}, bytes).ok());
  EXPECT_FALSE(readV4l2Depth({fourCc("YUYV"), 4, 4, 0}, bytes).ok());
  EXPECT_FALSE(readV4l2Depth({fourCc("INZI"), 4, 4, 0}, bytes).ok());
}

}  // namespace
}  // namespace hapticast::server
