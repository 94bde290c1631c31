// SPDX-License-Identifier: MIT
// Pictures from outside, the client's (a JPEG of the announced size) and the server's (image
// files): decoded or refused, and never larger than was asked for.
#include <opencv2/imgcodecs.hpp>

#include <cstdint>
#include <span>

#include "client/view/picture.hpp"
#include "server/source/picture/image_file.hpp"
#include "tests/fuzz/target.hpp"

namespace hapticast::fuzz::picture {

HAPTICAST_FUZZ_TARGET("picture") {
  const std::span bytes(data, size);
  // The client decodes what its stream announced, here 32 x 16.
  const cv::Size expected(32, 16);
  const cv::Mat picture = hapticast::client::decodeJpeg(bytes, expected);
  require(picture.empty() || (picture.size() == expected && picture.type() == CV_8UC3));

  const auto file = hapticast::server::decodeImage(bytes, cv::IMREAD_UNCHANGED);
  require(file.ok() != file.image.empty());
  require(!file.ok() || hapticast::server::sizeReadable(file.image.cols, file.image.rows));
  return 0;
}

}  // namespace hapticast::fuzz::picture
