// SPDX-License-Identifier: MIT
#include "client/view/picture.hpp"

#include <opencv2/imgcodecs.hpp>

namespace hapticast::client {

std::optional<cv::Size> jpegSize(std::span<const std::uint8_t> jpeg) {
  // ITU T.81 annex B: markers FF xx, segments with a big-endian length; SOF0..SOF15 but DHT, JPG,
  // DAC hold the size.
  if (jpeg.size() < 4 || jpeg[0] != 0xFF || jpeg[1] != 0xD8) return std::nullopt;
  std::size_t at = 2;
  while (at + 4 <= jpeg.size() && jpeg[at] == 0xFF) {
    const std::uint8_t marker = jpeg[at + 1];
    const std::size_t length = (std::size_t{jpeg[at + 2]} << 8U) | jpeg[at + 3];
    const bool frame_header =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (length < 2) return std::nullopt;
    if (frame_header) {
      if (length < 8 || at + 9 > jpeg.size()) return std::nullopt;
      return cv::Size((jpeg[at + 7] << 8) | jpeg[at + 8], (jpeg[at + 5] << 8) | jpeg[at + 6]);
    }
    at += 2 + length;
  }
  return std::nullopt;
}

cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected) {
  if (jpegSize(jpeg) != expected || expected.empty()) return {};
  const cv::Mat bytes(1, static_cast<int>(jpeg.size()), CV_8UC1,
                      const_cast<std::uint8_t*>(jpeg.data()));
  cv::Mat picture;
  try {
    picture = cv::imdecode(bytes, cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    return {};
  }
  return picture.size() == expected ? picture : cv::Mat();
}

}  // namespace hapticast::client
