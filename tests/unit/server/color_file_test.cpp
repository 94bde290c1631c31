// SPDX-License-Identifier: MIT
// Colour images in the formats that people have: PNG, JPEG, WebP, BMP, PPM. Made by OpenCV, cut,
// and with wrong headers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <random>

#include "server/source/folder/image_sequence.hpp"
#include "tests/unit/server/number_files.hpp"
#include "tests/unit/server/source_files.hpp"

namespace hapticast::server {
namespace {

using testing::HasSubstr;

/// A picture with another colour in each pixel.
cv::Mat colorSlope() {
  cv::Mat image(24, 36, CV_8UC3);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      image.at<cv::Vec3b>(v, u) = {static_cast<std::uint8_t>(7 * u),
                                   static_cast<std::uint8_t>(10 * v),
                                   static_cast<std::uint8_t>(u + v)};
    }
  }
  return image;
}

class ColorFile : public testing::Test {
 protected:
  void SetUp() override { folder.write("depth/0.png", cv::Mat(24, 36, CV_16UC1, cv::Scalar(900))); }
  /// Returns the bytes of the picture in a format.
  [[nodiscard]] std::string encode(const std::string& ending) const {
    const std::string name = "encoded" + ending;
    folder.write(name, colorSlope());
    std::ifstream in(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::string colorError(const std::string& ending, const std::string& bytes) const {
    folder.write("rgb/0" + ending, bytes);
    return errorOf([this] { ImageSequence(folder.string(), 0.0); });
  }
  [[nodiscard]] double colorDifference() const {
    ImageSequence source(folder.string(), 0.0);
    return cv::norm(source.read()->color, colorSlope(), cv::NORM_INF);
  }
  SourceFolder folder;
};

TEST_F(ColorFile, EachFormatIsRead) {
  for (const std::string ending : {".png", ".bmp", ".ppm", ".webp", ".jpg"}) {
    std::filesystem::remove_all(folder / "rgb");
    folder.write("rgb/0" + ending, colorSlope());
    const bool exact = ending == ".png" || ending == ".bmp" || ending == ".ppm";
    EXPECT_LE(colorDifference(), exact ? 0.0 : 80.0) << ending;
  }
}

TEST_F(ColorFile, AWebPWithoutLossesIsExact) {
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(cv::imencode(".webp", colorSlope(), bytes, {cv::IMWRITE_WEBP_QUALITY, 101}));
  folder.write("rgb/0.webp", std::string(bytes.begin(), bytes.end()));
  EXPECT_EQ(colorDifference(), 0.0);
}

TEST_F(ColorFile, ACutFileIsNamed) {
  for (const std::string ending : {".png", ".jpg", ".webp", ".bmp", ".ppm"}) {
    std::filesystem::remove_all(folder / "rgb");
    const std::string good = encode(ending);
    // Of the last 12 bytes of a PNG file, 4 are a mark and 4 its checksum.
    const std::size_t least = ending == ".png" ? 12 : 2;
    for (const std::size_t missing : {good.size() / 3, std::size_t{12}, least}) {
      EXPECT_THAT(colorError(ending, good.substr(0, good.size() - missing)),
                  HasSubstr("rgb/0" + ending + ": is cut off"))
          << missing;
    }
  }
}

TEST_F(ColorFile, AHugePictureIsRefusedByItsHeader) {
  EXPECT_THAT(colorError(".ppm", "P6\n# huge\n99999 99999\n255\n"), HasSubstr("is 99999x99999"));
  EXPECT_THAT(colorError(".ppm", "P6 00000000036 24 255\n"), HasSubstr("is not a whole"));
  std::filesystem::remove_all(folder / "rgb");
  std::string bmp = encode(".bmp");
  bmp.replace(18, 8, littleEndian(70'000, 4) + littleEndian(0x80000000U, 4));
  EXPECT_THAT(colorError(".bmp", bmp), HasSubstr("is 70000x2147483648, larger than"));
  std::filesystem::remove_all(folder / "rgb");
  const std::string canvas =
      "RIFF" + littleEndian(22, 4) + "WEBPVP8X" + littleEndian(10, 4) + littleEndian(0, 4);
  EXPECT_THAT(colorError(".webp", canvas + littleEndian(9'999, 3) + littleEndian(9, 3)),
              HasSubstr("is 10000x10, larger than"));
  std::string animated = canvas + littleEndian(35, 3) + littleEndian(23, 3);
  animated[20] = 2;
  EXPECT_THAT(colorError(".webp", animated), HasSubstr("is an animated WebP"));
}

TEST_F(ColorFile, NumbersAreNoColours) {
  EXPECT_THAT(colorError(".png", npyFile("|u1", "24, 36", std::string(864, 'x'))),
              HasSubstr("is a matrix of numbers, not a colour image"));
}

TEST_F(ColorFile, ChangedFilesAreRefusedOrHaveTheirSize) {
  std::mt19937 random(81);
  for (const std::string ending : {".bmp", ".ppm", ".webp"}) {
    const std::string good = encode(ending);
    for (int i = 0; i < 300; ++i) {
      std::string bytes = good;
      if (i % 3 == 0) bytes.resize(random() % bytes.size());
      for (auto n = 1 + random() % 6; n > 0 && !bytes.empty(); --n)
        bytes[random() % std::min<std::size_t>(bytes.size(), 60)] =
            static_cast<char>(random() % 256);
      const ImageResult image = decodeImage(
          {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, cv::IMREAD_COLOR);
      ASSERT_TRUE(!image.ok() || sizeReadable(image.image.cols, image.image.rows)) << ending;
    }
  }
}

}  // namespace
}  // namespace hapticast::server
