// SPDX-License-Identifier: MIT
#include "client/view/picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace hapticast::client {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kWidth_px = 64;
constexpr int kHeight_px = 48;
const cv::Size kSize(kWidth_px, kHeight_px);

cv::Mat ramp() {
  cv::Mat picture(kSize, CV_8UC3);
  for (int v = 0; v < kHeight_px; ++v) {
    for (int u = 0; u < kWidth_px; ++u) {
      picture.at<cv::Vec3b>(v, u) = {static_cast<std::uint8_t>(4 * u),
                                     static_cast<std::uint8_t>(5 * v), 128};
    }
  }
  return picture;
}

Bytes encoded(const cv::Mat& picture, const std::string& extension) {
  Bytes bytes;
  cv::imencode(extension, picture, bytes);
  return bytes;
}

/// The same JPEG, announcing another size.
Bytes announcing(Bytes jpeg, int width_px, int height_px) {
  const std::array<std::uint8_t, 2> frame_header{0xFF, 0xC0};
  const auto at = std::search(jpeg.begin(), jpeg.end(), frame_header.begin(), frame_header.end());
  at[5] = static_cast<std::uint8_t>(height_px >> 8);
  at[6] = static_cast<std::uint8_t>(height_px & 0xFF);
  at[7] = static_cast<std::uint8_t>(width_px >> 8);
  at[8] = static_cast<std::uint8_t>(width_px & 0xFF);
  return jpeg;
}

TEST(ClientPicture, IsDecoded) {
  const cv::Mat picture = decodeJpeg(encoded(ramp(), ".jpg"), kSize);
  ASSERT_EQ(picture.size(), kSize);
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_LT(cv::norm(picture, ramp(), cv::NORM_L1) / static_cast<double>(picture.total() * 3), 3.0);
}

TEST(ClientPicture, GreyOnesBecomeColour) {
  const cv::Mat grey(kSize, CV_8UC1, cv::Scalar(77));
  const cv::Mat picture = decodeJpeg(encoded(grey, ".jpg"), kSize);
  ASSERT_EQ(picture.type(), CV_8UC3);
  EXPECT_NEAR(picture.at<cv::Vec3b>(10, 10)[1], 77, 2);
}

TEST(ClientPicture, OfAnotherSizeIsRefused) {
  const Bytes jpeg = encoded(ramp(), ".jpg");
  EXPECT_TRUE(decodeJpeg(jpeg, {kHeight_px, kWidth_px}).empty());
  EXPECT_TRUE(decodeJpeg(jpeg, {kWidth_px + 1, kHeight_px}).empty());
  EXPECT_TRUE(decodeJpeg(jpeg, {0, 0}).empty());
  EXPECT_TRUE(decodeJpeg(jpeg, {-kWidth_px, -kHeight_px}).empty());
}

TEST(ClientPicture, ThatAnnouncesAHugeSizeIsRefused) {
  const Bytes huge = announcing(encoded(ramp(), ".jpg"), 65535, 65535);
  EXPECT_TRUE(decodeJpeg(huge, kSize).empty());
  const Bytes nothing = announcing(encoded(ramp(), ".jpg"), 0, 0);
  EXPECT_TRUE(decodeJpeg(nothing, {0, 0}).empty());
}

TEST(ClientPicture, ThatIsCutOffIsRefused) {
  const Bytes jpeg = encoded(ramp(), ".jpg");
  for (std::size_t size = 0; size < jpeg.size(); size += 7) {
    EXPECT_TRUE(decodeJpeg(std::span(jpeg).first(size), kSize).empty()) << size;
  }
}

TEST(ClientPicture, ProgressiveOnesAreDecoded) {
  Bytes bytes;
  cv::imencode(".jpg", ramp(), bytes, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  EXPECT_EQ(decodeJpeg(bytes, kSize).size(), kSize);
}

TEST(ClientPicture, ThatIsDamagedInsideIsRefused) {
  Bytes jpeg = encoded(ramp(), ".jpg");
  // The middle of the picture's data is gone; header and end are whole.
  const auto middle = jpeg.begin() + static_cast<std::ptrdiff_t>(jpeg.size() * 3 / 4);
  jpeg.erase(middle, middle + static_cast<std::ptrdiff_t>(jpeg.size() / 8));
  EXPECT_TRUE(decodeJpeg(jpeg, kSize).empty());
}

TEST(ClientPicture, ThatIsNoJpegIsRefused) {
  EXPECT_TRUE(decodeJpeg(encoded(ramp(), ".png"), kSize).empty());
  EXPECT_TRUE(decodeJpeg(Bytes(1000, 0xFF), kSize).empty());
  EXPECT_TRUE(decodeJpeg({}, kSize).empty());
  // A right header with nothing behind it but the end.
  Bytes header = encoded(ramp(), ".jpg");
  const std::array<std::uint8_t, 2> scan{0xFF, 0xDA};
  header.erase(std::search(header.begin(), header.end(), scan.begin(), scan.end()), header.end());
  header.insert(header.end(), {0xFF, 0xD9});
  EXPECT_TRUE(decodeJpeg(header, kSize).empty());
}

}  // namespace
}  // namespace hapticast::client
