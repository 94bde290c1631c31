// SPDX-License-Identifier: MIT
#include "server/source/picture/image_file.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace hapticast::server {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Start, `before`, and a frame header of 640 x 480 with `marker`.
Bytes withFrame(const Bytes& before, std::uint8_t marker = 0xC0) {
  Bytes bytes{0xFF, 0xD8};
  bytes.insert(bytes.end(), before.begin(), before.end());
  const Bytes frame{0xFF, marker, 0, 8, 8, 0x01, 0xE0, 0x02, 0x80};
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  return bytes;
}

TEST(JpegSize, IsReadFromTheFrameHeader) {
  constexpr PictureSize kSize{640, 480};
  EXPECT_EQ(jpegSize(withFrame({})), kSize);
  EXPECT_EQ(jpegSize(withFrame({0xFF, 0xE0, 0, 4, 1, 2})), kSize) << "after another segment";
  EXPECT_EQ(jpegSize(withFrame({0xFF, 0xFF})), kSize) << "after fill bytes";
  EXPECT_EQ(jpegSize(withFrame({0xFF, 0xC4, 0, 6, 0xFF, 0xC0, 0, 8})), kSize) << "after tables";
  for (const std::uint8_t marker : Bytes{0xC1, 0xC2, 0xC3, 0xC9, 0xCF}) {
    EXPECT_EQ(jpegSize(withFrame({}, marker)), kSize) << int{marker};
  }
}

TEST(JpegSize, IsNotMadeUp) {
  const Bytes whole = withFrame({0xFF, 0xE0, 0, 4, 1, 2});
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(jpegSize(std::span(whole).first(size)), std::nullopt) << "cut at " << size;
  }
  for (const std::uint8_t marker : Bytes{0xC4, 0xC8, 0xCC, 0xDA}) {
    EXPECT_EQ(jpegSize(withFrame({}, marker)), std::nullopt) << int{marker};
  }
  EXPECT_EQ(jpegSize(withFrame({0xFF, 0xE0, 0, 0})), std::nullopt) << "length below its own size";
  EXPECT_EQ(jpegSize(withFrame({0xFF, 0xE0, 0xFF, 0xFF})), std::nullopt) << "beyond the end";
  EXPECT_EQ(jpegSize(withFrame({1, 2, 3, 4})), std::nullopt) << "no marker";
  EXPECT_EQ(jpegSize(Bytes{0x89, 'P', 'N', 'G', 0, 0, 0, 0, 0, 0}), std::nullopt);
}

}  // namespace
}  // namespace hapticast::server
