// SPDX-License-Identifier: MIT
#include "client/view/picture.hpp"

#include <opencv2/imgcodecs.hpp>

#include "common/jpeg_size.hpp"

namespace hapticast::client {

cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected) {
  const PictureSize wanted{static_cast<std::uint32_t>(expected.width),
                           static_cast<std::uint32_t>(expected.height)};
  if (expected.empty() || jpegSize(jpeg) != wanted) return {};
  // What is cut off, the decoder would fill with grey.
  if (jpeg[jpeg.size() - 2] != 0xFF || jpeg[jpeg.size() - 1] != 0xD9) return {};
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
