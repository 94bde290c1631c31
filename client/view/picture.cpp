// SPDX-License-Identifier: MIT
#include "client/view/picture.hpp"

#include <turbojpeg.h>

#include <memory>

namespace hapticast::client {

namespace {

using Decompressor = std::unique_ptr<void, decltype(&tjDestroy)>;

}  // namespace

cv::Mat decodeJpeg(std::span<const std::uint8_t> jpeg, cv::Size expected) {
  if (expected.empty() || jpeg.empty()) return {};
  const Decompressor decompressor(tjInitDecompress(), &tjDestroy);
  cv::Size announced;
  int subsampling = 0;
  int color_space = 0;
  if (!decompressor ||
      tjDecompressHeader3(decompressor.get(), jpeg.data(), jpeg.size(), &announced.width,
                          &announced.height, &subsampling, &color_space) != 0 ||
      announced != expected) {
    return {};
  }
  cv::Mat picture(expected, CV_8UC3);
  // The decoder fills missing parts with grey and only warns. A progressive JPEG of a few bytes
  // could request any number of scans of the whole picture.
  constexpr int kFlags = TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS;
  const int failed =
      tjDecompress2(decompressor.get(), jpeg.data(), jpeg.size(), picture.data, expected.width,
                    static_cast<int>(picture.step), expected.height, TJPF_BGR, kFlags);
  return failed == 0 ? picture : cv::Mat();
}

}  // namespace hapticast::client
