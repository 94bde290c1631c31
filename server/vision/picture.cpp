// SPDX-License-Identifier: MIT
#include "server/vision/picture.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

namespace hapticast::server {

std::vector<std::uint8_t> encodePicture(const cv::Mat& color, int quality) {
  std::vector<std::uint8_t> bytes;
  if (color.empty() || color.type() != CV_8UC3) return bytes;
  if (!cv::imencode(".jpg", color, bytes, {cv::IMWRITE_JPEG_QUALITY, std::clamp(quality, 1, 100)}))
    bytes.clear();
  return bytes;
}

}  // namespace hapticast::server
